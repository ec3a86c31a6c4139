#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "daemon/api/server.hpp"
#include "daemon/api/status_view.hpp"
#include "daemon/app/arm_commands.hpp"
#include "daemon/app/device_threads.hpp"
#include "daemon/app/guard_keeper.hpp"
#include "daemon/app/lateness_watch.hpp"
#include "daemon/app/leases.hpp"
#include "daemon/app/options.hpp"
#include "daemon/app/recording_writer.hpp"
#include "daemon/app/repeated_warnings.hpp"
#include "daemon/app/return_watch.hpp"
#include "daemon/app/safety_thread.hpp"
#include "daemon/app/serial_lines.hpp"
#include "daemon/app/service_notifier.hpp"
#include "daemon/app/servo_threads.hpp"
#include "daemon/app/status_source.hpp"
#include "daemon/config/config.hpp"
#include "daemon/link/tty_ports.hpp"
#include "daemon/link/udp_network.hpp"
#include "daemon/session/plugins.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/event_fd.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/serial_line.hpp"

namespace thimble::app {

// The running daemon: the net and control planes on one thread, one servo thread per arm.
//
// Thread: made, run and destroyed on the main thread. Not RT.
// Errors: start() gives the first thing that is missing; afterwards nothing ends it but a signal,
//         --for, the service manager, or an arm that came and cannot be served: run() gives that.
class Daemon final : private api::StatusView {
 public:
  // `plugins`, which must outlive it, has what the configuration names.
  Daemon(const config::Config& config, const Options& options, const session::Plugins& plugins);
  ~Daemon() override;

  [[nodiscard]] Result<void> start(const linux::RealtimeProcess& process);
  // Serves until told to stop; then every force has ramped to zero and all is written. Errors: what
  // ended it unasked, which the log has: whoever started it should start it anew.
  [[nodiscard]] Result<void> run();
  // After run(), or a start that failed: closes the arms and all that the kernel may hold up,
  // within `patience` altogether. Errors: Timeout, naming what is not closed, or System, where no
  // thread could be had to wait with: then nothing of it may be destroyed, and whoever called ends
  // the process.
  [[nodiscard]] Result<void> close(Duration patience);
  // The status at the end, for --summary; before close().
  [[nodiscard]] api::Status final_status() const { return status(); }

 private:
  [[nodiscard]] api::Status status() const override;

  [[nodiscard]] Result<void> close_all(Duration patience);
  [[nodiscard]] Result<void> close_arms(Duration patience);
  [[nodiscard]] Result<void> start_buses(const linux::RealtimeProcess& process);
  void hold_back_after_crash();
  void tell_what_is_missing();
  void wait_for_signals();
  void wait_for_wake();
  void pump();
  void supervise();
  void warn(const std::string& trouble);
  void tell_of(const session::ArmSession& arm, ReturnWatch::Change change);
  void take_over(session::Runtime::Arrival arrival);
  void look_after_arms();
  void look_after_safety();
  void take_recordings();
  void tell_service_manager();
  void pet_watchdog();

  config::Config config_;
  Options options_;
  linux::MonotonicClock clock_;
  MonotonicTime started_;
  const session::Plugins& plugins_;
  Leases leases_;
  LatenessWatch lateness_;
  RecordingBook recordings_;
  RepeatedWarnings warnings_;
  ReturnWatch returns_;

  SerialLines line_threads_{linux::share_serial_line};
  boost::asio::io_context io_{1};
  link::UdpNetwork network_{io_};
  link::TtyPorts lines_{io_, [this](const std::string& node, std::uint32_t bit_per_s) {
                          return line_threads_.open(node, bit_per_s);
                        }};
  boost::asio::signal_set signals_{io_};
  boost::asio::steady_timer pump_timer_{io_};
  boost::asio::steady_timer supervise_timer_{io_};
  boost::asio::steady_timer end_timer_{io_};
  std::unique_ptr<linux::EventFd> wake_;
  boost::asio::posix::stream_descriptor wake_descriptor_{io_};
  ServiceNotifier notifier_;
  MonotonicTime watchdog_due_{};
  std::string told_;         // to the service manager
  std::string told_safety_;  // to the log
  Result<void> ending_;      // an error: not as told

  std::unique_ptr<RecordingWriter> recorder_;
  std::unique_ptr<linux::BusEnumerator> buses_;    // nullptr: every device is simulated
  std::unique_ptr<GuardKeeper> guards_;            // of its devices
  std::unique_ptr<DeviceThreads> device_threads_;  // of its devices, which they close at the end
  std::unique_ptr<session::Runtime> runtime_;
  std::unique_ptr<SafetyThread> safety_;  // nullptr: no such lines
  std::optional<ArmCommands> commands_;
  std::unique_ptr<api::Server> server_;
  std::unique_ptr<ServoThreads> threads_;  // last: stops first
};

}  // namespace thimble::app
