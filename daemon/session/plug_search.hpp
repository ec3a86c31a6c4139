#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/devices/device_executor.hpp"
#include "daemon/session/retry_pace.hpp"
#include "hal/base/contain.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::session {

// Looks for something that may not be there yet, and that the kernel or another process may hold
// up: nobody waits for it here (docs/decisions/0389). Found: can be moved.
//
// Thread: one, from which `executor` takes tasks; `find` runs where they do. Not RT. Ownership:
// the executor, and what `find` uses, outlive it; what nobody took ends in a task.
template <class Found>
class PlugSearch {
 public:
  using Find = std::function<Result<Found>()>;
  // `sought`: says Busy's sentence, "a CAM board is looked for".
  PlugSearch(devices::DeviceExecutor& executor, Find find, std::string sought)
      : executor_(&executor),
        find_(std::move(find)),
        sought_(std::move(sought)),
        why_not_{Errc::Busy, sought_} {}
  ~PlugSearch() {
    // Whoever is the last to hold it, it ends there.
    if (slot_ != nullptr) executor_->post([slot = std::move(slot_)]() mutable { slot.reset(); });
  }
  PlugSearch(const PlugSearch&) = delete;
  PlugSearch& operator=(const PlugSearch&) = delete;

  // Looks again where nobody does, less and less often while there is none that works (RetryPace).
  // `now` is the caller's own time. Errors: Busy while it is looked for; those of `find`.
  [[nodiscard]] Result<Found> take(MonotonicTime now) {
    if (slot_ == nullptr && pace_.is_due(now)) begin(now);
    if (slot_ == nullptr) return tl::unexpected(why_not_);
    if (!slot_->is_done.load()) return fail(Errc::Busy, sought_);
    Result<Found> found = *std::move(std::exchange(slot_, nullptr)->outcome);
    if (!found) why_not_ = found.error();
    return found;
  }
  // What was taken is of use: when it is gone, the next is looked for at once.
  void note_works() noexcept { pace_.restart(); }
  // From the next look on.
  void look_by(Find find) { find_ = std::move(find); }

 private:
  struct Slot {
    std::atomic<bool> is_done{false};
    std::optional<Result<Found>> outcome;
  };

  void begin(MonotonicTime now) {
    pace_.tried(now);
    slot_ = std::make_shared<Slot>();
    executor_->post([slot = slot_, find = find_] {
      slot->outcome = contain(find);
      slot->is_done.store(true);
    });
  }

  devices::DeviceExecutor* executor_;
  Find find_;
  std::string sought_;
  std::shared_ptr<Slot> slot_;  // while it is looked for
  RetryPace pace_;
  Error why_not_;
};

}  // namespace thimble::session
