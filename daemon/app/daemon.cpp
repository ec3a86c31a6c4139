#include "daemon/app/daemon.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <string_view>
#include <utility>

#include "daemon/app/recording_folder.hpp"
#include "daemon/app/status_source.hpp"
#include "daemon/config/paths.hpp"
#include "daemon/world/cam/automaton_file.hpp"
#include "hal/linux/board_window.hpp"

namespace thimble::app {
namespace {

// How soon a person learns of a stop or an arrival; far from any loop of the servo.
constexpr Duration kSupervision = std::chrono::milliseconds(20);
// systemd starts it, and it opens two files. Ours.
constexpr std::chrono::seconds kBoardHelperPatience{2};
// At the end. A recording is half a megabyte, a busy disk needs a second. Ours.
constexpr std::chrono::seconds kDiskPatience{10};

Leases leases_of(const config::Config& config) {
  std::vector<Leases::Arm> arms;
  for (const config::ArmConfig& arm : config.arms) arms.push_back({arm.name, arm.activate});
  return Leases(arms);
}

api::ServerSettings server_settings(const config::Config& config) {
  api::ServerSettings settings;
  settings.socket_path =
      config.daemon.socket.value_or(config::default_socket_path(config::process_environment()));
  settings.socket_mode = config.daemon.socket_mode;
  settings.group = config.daemon.group.value_or("");
  settings.max_state_bytes = world::cam::kMaxStateBytes;
  settings.max_connections += config.arms.size();  // whoever holds an arm keeps a seat
  return settings;
}

bool is_ignored(int number) noexcept {
  struct sigaction now {};
  return ::sigaction(number, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

Daemon::Daemon(const config::Config& config, const Options& options,
               const session::Plugins& plugins)
    : config_(config),
      options_(options),
      started_(clock_.now()),
      plugins_(plugins),
      leases_(leases_of(config)) {}

Daemon::~Daemon() {
  threads_.reset();
  // Handlers that wait hold no resources of their own, but the descriptor is the wake's.
  if (wake_descriptor_.is_open()) wake_descriptor_.release();
}

Result<void> Daemon::start(const linux::RealtimeProcess& process) {
  Result<std::unique_ptr<linux::EventFd>> wake = linux::EventFd::create();
  if (!wake) return tl::unexpected(wake.error());
  wake_descriptor_.assign((wake_ = *std::move(wake))->fd());
  const std::string usual = config::default_flight_directory(config::process_environment());
  recorder_ = std::make_unique<RecordingWriter>(config_.daemon.flight_directory.value_or(usual),
                                                config_.arms.size());

  if (has_real_device(config_)) {
    if (Result<void> found = start_buses(process); !found) return found;
  }
  session::RigParts parts{plugins_.models, plugins_.drivers};
  parts.real_buses = buses_.get();
  parts.guards = guards_.get();
  parts.executor_for = [this](const std::string& arm) -> devices::DeviceExecutor& {
    return device_threads_->executor_for(arm);
  };
  parts.executor_for_board = [this](const std::string& world) -> devices::DeviceExecutor& {
    return device_threads_->executor_for_board(world);
  };
  parts.open_board_window = [] {
    return linux::open_board_window("/run/thimble-board.sock", kBoardHelperPatience);
  };
  parts.stopwatch = parts.real_clock = &clock_;
  parts.wake = wake_.get();
  parts.network = &network_;
  parts.lines = &lines_;
  parts.on_wait = [this](const Error& why) {
    spdlog::warn("waiting: {}", why.message);
    notifier_.status("waiting: " + why.message);
  };
  // Sixteenths of a second of the machine's uptime: larger after a restart of the daemon.
  parts.first_session = static_cast<std::uint32_t>(seconds(clock_.now().since_epoch) * 16.0) + 1;
  Result<std::unique_ptr<session::Runtime>> runtime = session::Runtime::create(config_, parts);
  if (!runtime) return tl::unexpected(runtime.error());
  runtime_ = *std::move(runtime);
  if (config_.safety) {
    auto safety = SafetyThread::start(config_, *runtime_, clock_, process);
    if (!safety) return tl::unexpected(safety.error());
    safety_ = *std::move(safety);
  }
  commands_.emplace(*runtime_, leases_, clock_, safety_ ? &safety_->session() : nullptr);

  // Until here a signal ends the process at once, as a person expects of one that is loading a
  // large volume: no arm is active. From here it must find its handler: the socket file goes again.
  wait_for_signals();
  Result<std::unique_ptr<api::Server>> server =
      api::Server::create(io_, server_settings(config_), *this, *commands_);
  if (!server) return tl::unexpected(server.error());
  server_ = *std::move(server);
  if (server_->has_replaced_dead_one()) hold_back_after_crash();

  wait_for_wake();
  Result<std::unique_ptr<ServoThreads>> threads =
      ServoThreads::start(config_.servo, *runtime_, process);
  if (!threads) return tl::unexpected(threads.error());
  threads_ = *std::move(threads);
  tell_what_is_missing();
  return {};
}

Result<void> Daemon::start_buses(const linux::RealtimeProcess& process) {
  buses_ = std::make_unique<linux::BusEnumerator>(
      linux::BusSettings{clock_, bus_thread_settings(config_.servo), process.report()},
      [this](const bus::BusDeviceInfo& info) { return plugins_.drivers.knows(info); });
  GuardSettings guards = default_guard_settings();
  guards.share = [this](const bus::DeviceAddress& address) { return buses_->share(address); };
  guards_ = std::make_unique<GuardKeeper>(std::move(guards));
  auto threads = DeviceThreads::start(config_);
  if (!threads) return tl::unexpected(threads.error());
  device_threads_ = *std::move(threads);
  return {};
}

void Daemon::tell_what_is_missing() {
  for (const std::string& right : threads_->missing()) spdlog::warn("degraded: {}", right);
  for (const auto& arm : runtime_->arms()) {
    if (const std::string trouble = arm->trouble(); !trouble.empty()) warn(trouble);
    const session::AwaitedArm* const awaited = arm->awaited();
    if (awaited != nullptr && awaited->has_stand_in()) {
      spdlog::warn("degraded: {}", awaited->sentence());
    }
  }
  for (const auto& host : runtime_->worlds()) {
    if (host->loss()) spdlog::warn("degraded: {}", *host->loss());
  }
}

Result<void> Daemon::run() {
  if (options_.for_s) {
    end_timer_.expires_after(from_seconds(*options_.for_s));
    end_timer_.async_wait([this](const boost::system::error_code& error) {
      if (!error) io_.stop();
    });
  }
  supervise();
  notifier_.ready("running");
  spdlog::info("ready: {} arm(s), {} world(s), socket {}", runtime_->arms().size(),
               runtime_->worlds().size(), server_settings(config_).socket_path);
  io_.run();
  notifier_.stopping();
  threads_->stop();
  take_recordings();
  if (!recorder_->flush(kDiskPatience)) {
    spdlog::error("a flight recording is lost: its disk did not take it in {} s",
                  kDiskPatience.count());
  }
  take_recordings();
  return ending_;
}

// An arm that needs nobody to be calibrated, as a Falcon whose firmware runs on, would push again a
// second after it was let go. Before there are servos.
void Daemon::hold_back_after_crash() {
  for (std::size_t i = 0; i < runtime_->arms().size(); ++i) {
    if (leases_.holder(i) == Leases::Holder::Nobody) continue;
    session::ArmSession& session = runtime_->arms()[i]->session();
    const std::string& name = session.config().name;
    static_cast<void>(leases_.release(name));
    session.controls().want_active = false;
    spdlog::warn(
        "arm '{}' is not activated: the daemon before this one was killed or came to grief; look "
        "at the arm, then: thimble activate {}",
        name, name);
  }
}

void Daemon::wait_for_signals() {
  signals_.add(SIGINT);
  signals_.add(SIGTERM);
  // The terminal was closed, or the connection to it lost; not where that was refused (nohup).
  if (!is_ignored(SIGHUP)) signals_.add(SIGHUP);
  signals_.async_wait([this](const boost::system::error_code& error, int number) {
    if (error) return;
    spdlog::info("{}: stopping", number == SIGINT   ? "interrupted"
                                 : number == SIGHUP ? "the terminal is gone"
                                                    : "terminated");
    io_.stop();
  });
}

void Daemon::wait_for_wake() {
  wake_descriptor_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                              [this](const boost::system::error_code& error) {
                                if (error) return;
                                wake_->drain();
                                pump();
                                wait_for_wake();
                              });
}

void Daemon::pump() {
  const std::optional<MonotonicTime> due = runtime_->pump(clock_.now());
  if (!due) return;
  pump_timer_.expires_after(*due - clock_.now());
  pump_timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) pump();
  });
}

void Daemon::supervise() {
  for (const Error& trouble : runtime_->follow_buses(clock_.now())) warn(trouble.message);
  for (session::Runtime::Arrival& arrival : runtime_->take_arrivals()) {
    take_over(std::move(arrival));
  }
  look_after_arms();
  look_after_safety();
  pump();  // edits of worlds come without a servo's wake
  commands_->poll();
  take_recordings();
  tell_service_manager();
  pet_watchdog();
  notifier_.retry();
  supervise_timer_.expires_after(kSupervision);
  supervise_timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) supervise();
  });
}

void Daemon::warn(const std::string& trouble) {
  const auto warning = warnings_.admit(trouble + "; trying again", clock_.now());
  if (warning) spdlog::warn("{}", *warning);
}

void Daemon::take_over(session::Runtime::Arrival arrival) {
  const std::size_t arm = arrival.arm;
  const bool has_stand_in = runtime_->arms()[arm]->awaited()->has_stand_in();
  const std::string simulated = runtime_->arms()[arm]->session().config().device;
  if (safety_) safety_->session().leave_out(arm);
  threads_->stop(arm);
  take_recordings();
  // Ends after the exchange: the thread of the safety lines waits for that.
  std::unique_ptr<session::ArmRig> replaced;
  const auto exchange = [&] { replaced = runtime_->take_over(std::move(arrival)); };
  if (safety_) {
    safety_->session().exchange_arms(exchange);
  } else {
    exchange();
  }
  replaced.reset();
  returns_.forget(arm);
  const session::ArmSession& real = runtime_->arms()[arm]->session();
  if (has_stand_in) {
    spdlog::info("arm '{}': {} is there and takes over from {}; calibrate it, then activate it",
                 real.config().name, real.config().device, simulated);
  } else {
    spdlog::info("arm '{}': {} is there now", real.config().name, real.config().device);
  }
  const Result<void> started = threads_->start(arm);
  if (started) return;
  // An arm that nobody serves is no service: let the service manager start anew.
  ending_ = tl::unexpected(
      started.error().in("arm '" + real.config().name + "': its servo could not be started"));
  spdlog::error("{}", ending_.error().message);
  io_.stop();
}

void Daemon::look_after_arms() {
  for (std::size_t i = 0; i < runtime_->arms().size(); ++i) {
    session::ArmSession& arm = runtime_->arms()[i]->session();
    const servo::ServoSnapshot& seen = arm.snapshot();
    lateness_.note(i, clock_.now(), seen.overruns);
    tell_of(arm, returns_.note(i, seen.frame.state));
  }
}

// An arm may come and go as often as it likes: a line a minute of it is enough.
void Daemon::tell_of(const session::ArmSession& arm, ReturnWatch::Change change) {
  if (change == ReturnWatch::Change::None) return;
  const auto line = warnings_.admit(sentence_of(arm.config(), change), clock_.now());
  const bool has_left = change == ReturnWatch::Change::Left;
  if (line) spdlog::log(has_left ? spdlog::level::err : spdlog::level::info, "{}", *line);
}

void Daemon::look_after_safety() {
  if (!safety_) return;
  safety_->session().supervise(clock_.now());
  std::string now = safety_->session().explanation();
  if (now == told_safety_) return;
  told_safety_ = now;
  const bool is_usual = now.empty() || now.starts_with(session::kNotYetCleared);
  // A wire that chatters says the same few things again and again.
  const auto line =
      warnings_.admit("safety lines: " + (now.empty() ? "nothing is stopped" : now), clock_.now());
  if (line) spdlog::log(is_usual ? spdlog::level::info : spdlog::level::warn, "{}", *line);
}

// One line for `systemctl status`, told when it changes: "right active; left fault (overspeed)".
void Daemon::tell_service_manager() {
  std::string line;
  for (const auto& arm : runtime_->arms()) {
    const servo::ServoSnapshot& snapshot = arm->session().snapshot();
    if (!line.empty()) line += "; ";
    line += arm->session().config().name + " " + std::string(to_string(snapshot.frame.state));
    if (snapshot.fault.code != FaultCode::None) {
      line += " (" + std::string(to_string(snapshot.fault.code)) + ")";
    }
  }
  if (line.empty() || line == told_) return;
  told_ = line;
  notifier_.status(line);
}

void Daemon::take_recordings() {
  for (const auto& arm : runtime_->arms()) {
    while (std::optional<session::Recording> recording = arm->session().take_recording()) {
      const servo::FlightHeader& header = recording->header;
      // Of one that left is told at once, recorded or not: tell_of().
      if (header.fault.code != FaultCode::Disconnected) {
        spdlog::error("arm '{}' stopped: {}", header.arm, explain(header.fault.code));
      }
      recorder_->write(*std::move(recording));
    }
  }
  if (const std::optional<std::string> doubt = recorder_->take_doubt()) {
    spdlog::warn("degraded: no flight recording can be written: {}", *doubt);
  }
  for (const RecordingWriter::Outcome& outcome : recorder_->finished()) {
    recordings_.note(outcome.arm, outcome.stop,
                     outcome.path.empty() ? outcome.error : outcome.path);
    if (outcome.path.empty()) {
      spdlog::error("the flight recording of arm '{}' could not be written: {}", outcome.arm,
                    outcome.error);
    } else {
      spdlog::info("flight recording of arm '{}': {}", outcome.arm, outcome.path);
      if (outcome.removed > 0) {
        spdlog::info("removed {} old flight recording(s): of each arm the newest {} are kept",
                     outcome.removed, kMaxRecordings);
      }
    }
  }
}

void Daemon::pet_watchdog() {
  const std::optional<Duration> interval = notifier_.watchdog_interval();
  if (!interval || clock_.now() < watchdog_due_) return;
  // A servo that hangs must end in a restart: only a moving one is worth a ping.
  if (!threads_->have_all_ticked()) return;
  notifier_.alive();
  watchdog_due_ = clock_.now() + *interval / 2;
}

api::Status Daemon::status() const {
  return collect_status(*runtime_, {leases_, threads_.get(), recordings_, lateness_, started_,
                                    clock_.now(), safety_ ? &safety_->session() : nullptr});
}

}  // namespace thimble::app
