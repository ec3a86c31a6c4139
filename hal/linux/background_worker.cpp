#include "hal/linux/background_worker.hpp"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

namespace thimble::linux {

struct BackgroundWorker::Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Task> tasks;  // the first one is under way
  bool is_ending{false};

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return is_ending || !tasks.empty(); });
      if (tasks.empty()) return;
      const Task task = tasks.front();
      lock.unlock();
      task();
      lock.lock();
      tasks.pop_front();
      changed.notify_all();
    }
  }
};

BackgroundWorker::BackgroundWorker()
    : shared_(std::make_shared<Shared>()), thread_([shared = shared_] { shared->run(); }) {}

BackgroundWorker::~BackgroundWorker() {
  std::unique_lock lock(shared_->mutex);
  const bool is_idle = shared_->tasks.empty();
  shared_->is_ending = true;
  shared_->tasks.resize(is_idle ? 0 : 1);  // what has not begun is not begun any more
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
  shared_->changed.wait(lock, [this] { return shared_->tasks.empty(); });
}

bool BackgroundWorker::wait(Duration patience) {
  std::unique_lock lock(shared_->mutex);
  return shared_->changed.wait_for(lock, patience, [this] { return shared_->tasks.empty(); });
}

}  // namespace thimble::linux
