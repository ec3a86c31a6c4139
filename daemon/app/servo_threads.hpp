#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/base/result.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/realtime_thread.hpp"

namespace thimble::app {

// How the threads of real buses run: as the servos, on any CPU.
[[nodiscard]] linux::RealtimeThreadSettings bus_thread_settings(const config::ServoConfig& servo);

// One real-time thread per arm, each running that arm's servo until stopped.
//
// Thread: the control thread. Ownership: the runtime and the process's rights must outlive it;
// the destructor stops and joins.
class ServoThreads {
 public:
  // Errors: Permission when the configuration requires real-time rights that are missing.
  [[nodiscard]] static Result<std::unique_ptr<ServoThreads>> start(
      const config::ServoConfig& servo, session::Runtime& runtime,
      const linux::RealtimeProcess& process);
  ~ServoThreads();

  // Ramps every force to zero and ends the threads. May be called twice.
  void stop();
  // The same for one arm, whose rig may then be put away; start() runs the one that is there then.
  void stop(std::size_t arm);
  [[nodiscard]] Result<void> start(std::size_t arm);
  [[nodiscard]] bool is_realtime(std::size_t arm) const;
  // Every right that is missing, each named once.
  [[nodiscard]] std::vector<std::string> missing() const;
  // True when every servo has ticked since the previous call.
  [[nodiscard]] bool have_all_ticked();

 private:
  // One arm's; stays where it is, for its thread looks at it.
  struct Servo {
    std::atomic<bool> is_stopping{false};
    std::uint64_t ticks_seen{0};
    linux::RealtimeReport report;
    std::unique_ptr<linux::RealtimeThread> thread;  // last: joins first
  };

  ServoThreads(const config::ServoConfig& servo, session::Runtime& runtime,
               const linux::RealtimeProcess& process)
      : config_(servo), runtime_(runtime), process_(process) {}

  config::ServoConfig config_;
  session::Runtime& runtime_;
  const linux::RealtimeProcess& process_;
  std::vector<std::unique_ptr<Servo>> servos_;
};

}  // namespace thimble::app
