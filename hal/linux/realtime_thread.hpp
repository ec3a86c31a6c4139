#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hal/base/realtime_priority.hpp"
#include "hal/base/result.hpp"
#include "hal/linux/realtime_report.hpp"

namespace thimble::linux {

struct RealtimeThreadSettings {
  std::string name{};  // the first 15 bytes show in ps and perf
  RealtimePolicy policy{RealtimePolicy::BestEffort};
  int priority{kServoPriority};   // 1 to kMaxPriority
  std::optional<unsigned> cpu{};  // pinned to this one
};

// A thread for a servo: SCHED_FIFO, optionally pinned, 256 KiB of stack already in memory,
// denormal floats flushed to zero (x86), and all signals left to other threads.
//
// Thread: any non-RT one, one at a time. Ownership: the destructor joins: stop the body before.
class RealtimeThread {
 public:
  // Runs `body` once the rights are known; it must not throw. `process` is what
  // RealtimeProcess reported; report() adds the thread's part to it.
  // InvalidArgument for a priority out of range; Permission when the policy is Required and
  // anything is missing: then `body` never ran.
  [[nodiscard]] static Result<std::unique_ptr<RealtimeThread>> start(
      const RealtimeThreadSettings& settings, const RealtimeReport& process,
      std::function<void()> body);
  ~RealtimeThread();
  RealtimeThread(const RealtimeThread&) = delete;
  RealtimeThread& operator=(const RealtimeThread&) = delete;

  [[nodiscard]] const RealtimeReport& report() const noexcept;

 private:
  struct Shared;
  explicit RealtimeThread(std::unique_ptr<Shared> shared) noexcept;
  std::unique_ptr<Shared> shared_;
};

}  // namespace thimble::linux
