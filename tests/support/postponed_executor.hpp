#pragma once

#include <deque>
#include <utility>

#include "daemon/devices/device_executor.hpp"

namespace thimble::test {

// Work that lasts until the test says that it is done.
class PostponedExecutor final : public devices::DeviceExecutor {
 public:
  explicit PostponedExecutor(bool is_postponing = true) : is_postponing_(is_postponing) {}
  void post(Task task) override {
    tasks_.push_back(std::move(task));
    if (!is_postponing_) do_all();
  }
  // From now on, or not.
  void postpone(bool is_postponing) noexcept { is_postponing_ = is_postponing; }
  [[nodiscard]] std::size_t waiting() const noexcept { return tasks_.size(); }
  // The next one, if any.
  void do_one() {
    if (tasks_.empty()) return;
    const Task task = std::exchange(tasks_.front(), nullptr);
    tasks_.pop_front();
    task();
  }
  void do_all() {
    while (waiting() > 0) do_one();
  }

 private:
  std::deque<Task> tasks_;
  bool is_postponing_;
};

}  // namespace thimble::test
