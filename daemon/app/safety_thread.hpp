#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "daemon/config/config.hpp"
#include "daemon/session/runtime.hpp"
#include "daemon/session/safety_session.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/gpio_lines.hpp"
#include "hal/linux/event_fd.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/realtime_thread.hpp"
#include "sim/bus/sim_gpio.hpp"

namespace thimble::app {

// The thread that looks after the safety lines of a configuration: it sleeps until a line changes,
// SafetySession::kStep at most. On a simulated chip a hand holds the deadman, and lets go of it for
// a moment when the status asks for that.
//
// Thread: the control thread; session() as there. Ownership: runtime, clock and the process's
// rights must outlive it; the destructor stops and joins, and the outputs go low.
class SafetyThread {
 public:
  // `config` has a [safety]. No arm of the runtime may be driven from here on until a person
  // clears. Errors: of EventFd and RealtimeThread::start(); lines that are not there are no error.
  [[nodiscard]] static Result<std::unique_ptr<SafetyThread>> start(
      const config::Config& config, session::Runtime& runtime, const Clock& clock,
      const linux::RealtimeProcess& process);
  ~SafetyThread();
  SafetyThread(const SafetyThread&) = delete;
  SafetyThread& operator=(const SafetyThread&) = delete;

  [[nodiscard]] session::SafetySession& session() noexcept { return *session_; }

 private:
  SafetyThread(const config::Config& config, const Clock& clock,
               const linux::RealtimeProcess& process, std::unique_ptr<linux::EventFd> wake);
  void run() noexcept;
  void obey(MonotonicTime now) noexcept;

  const Clock& clock_;
  std::unique_ptr<linux::EventFd> wake_;
  std::optional<sim::SimGpioChip> sim_chip_;
  struct Hand {
    std::size_t line;
    bool is_closed_high;
    MonotonicTime lets_go_until{};
  };
  std::optional<Hand> sim_hand_;  // on the deadman of that chip
  std::unique_ptr<bus::GpioChips> chips_;
  std::unique_ptr<session::SafetySession> session_;
  std::atomic<bool> is_over_{false};
  std::unique_ptr<linux::RealtimeThread> thread_;  // last: it uses all of the above
};

}  // namespace thimble::app
