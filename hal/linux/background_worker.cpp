#include "hal/linux/background_worker.hpp"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

#include "hal/base/contain.hpp"

namespace thimble::linux {

struct BackgroundWorker::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Task> tasks;  // that have not begun
  bool is_under_way{false};
  bool is_ending{false};

  [[nodiscard]] bool is_idle() const { return tasks.empty() && !is_under_way; }

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return is_ending || !tasks.empty(); });
      if (tasks.empty()) return;
      is_under_way = true;
      {
        const Task task = std::move(tasks.front());
        tasks.pop_front();
        lock.unlock();
        static_cast<void>(contain(task));
      }  // what it owned may take long to end, too: not with the lock
      lock.lock();
      is_under_way = false;
      changed.notify_all();
    }
  }
};

BackgroundWorker::BackgroundWorker()
    : shared_(std::make_shared<Shared>()), thread_([shared = shared_] { shared->run(); }) {}

BackgroundWorker::~BackgroundWorker() {
  std::unique_lock lock(shared_->mutex);
  const bool is_idle = shared_->is_idle();
  shared_->is_ending = true;
  // The first is done even where the thread has not come to it yet; none of the rest.
  std::deque<Task> left = std::exchange(shared_->tasks, {});
  if (!shared_->is_under_way && !left.empty()) {
    shared_->tasks.push_back(std::move(left.front()));
    left.pop_front();
  }
  shared_->changed.notify_all();
  lock.unlock();
  if (is_idle) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

void BackgroundWorker::post(Task task) {
  const std::lock_guard lock(shared_->mutex);
  shared_->tasks.push_back(std::move(task));
  shared_->changed.notify_all();
}

void BackgroundWorker::finish() {
  std::unique_lock lock(shared_->mutex);
  shared_->changed.wait(lock, [this] { return shared_->is_idle(); });
}

bool BackgroundWorker::wait(Duration patience) {
  std::unique_lock lock(shared_->mutex);
  return shared_->changed.wait_for(lock, patience, [this] { return shared_->is_idle(); });
}

}  // namespace thimble::linux
