#include "tests/campaign/campaign.hpp"

#include <algorithm>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "tests/campaign/dice.hpp"

namespace thimble::campaign {
namespace {

class Campaign {
 public:
  Campaign(const Order& order, const Planted& planted,
           const std::function<void(const Tally&)>& progress)
      : order_(order), planted_(&planted), progress_(&progress) {}

  void work() {
    while (const std::optional<Task> task = next()) {
      done(*task, play(task->programme, *planted_));
    }
  }
  [[nodiscard]] Outcome take() { return std::move(outcome_); }

 private:
  struct Task {
    std::uint64_t episode{0};
    Programme programme;
  };

  std::optional<Task> next() {
    const std::lock_guard lock(mutex_);
    if (planned_ >= order_.ticks || outcome_.failure) return std::nullopt;
    Task task{next_, programme_of(order_, next_)};
    ++next_;
    task.programme.ticks = std::min(task.programme.ticks, order_.ticks - planned_);
    planned_ += task.programme.ticks;
    return task;
  }

  void done(const Task& task, const Ending& ending) {
    const std::lock_guard lock(mutex_);
    outcome_.tally.add(ending.tally);
    outcome_.trace += derive(ending.trace, task.episode);
    // Others were begun before: the first by number counts.
    const bool is_first = !outcome_.failure || task.episode < outcome_.failure->episode;
    if (ending.breach && is_first) outcome_.failure = {task.episode, task.programme, ending};
    if (*progress_) (*progress_)(outcome_.tally);
  }

  Order order_;
  const Planted* planted_;
  const std::function<void(const Tally&)>* progress_;
  std::mutex mutex_;
  std::uint64_t next_{0};
  std::uint64_t planned_{0};  // ticks of all tasks so far
  Outcome outcome_;
};

}  // namespace

Programme programme_of(const Order& order, std::uint64_t episode) {
  return draw(order.seed, episode);
}

Outcome run(const Order& order, const Planted& planted,
            const std::function<void(const Tally&)>& progress) {
  Campaign campaign(order, planted, progress);
  std::vector<std::jthread> others;
  for (unsigned job = 1; job < order.jobs; ++job) {
    others.emplace_back([&campaign] { campaign.work(); });
  }
  campaign.work();
  others.clear();  // joins
  return campaign.take();
}

}  // namespace thimble::campaign
