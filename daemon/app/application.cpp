#include "daemon/app/application.hpp"

#include <fcntl.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/app/daemon.hpp"
#include "daemon/app/exit_code.hpp"
#include "daemon/config/load.hpp"
#include "daemon/session/inspect.hpp"
#include "daemon/session/plugins.hpp"
#include "hal/linux/background_worker.hpp"
#include "hal/linux/line_output.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/standard_streams.hpp"

namespace thimble::app {
namespace {

// Ours; with those of recordings, 10 s, they are within TimeoutStopSec= of the unit.
constexpr Duration kSummaryPatience = std::chrono::seconds(2);
constexpr Duration kClosingPatience = std::chrono::seconds(5);

// A log that nobody reads must not hold up the thread that looks after the arms.
class StandardErrorSink final : public spdlog::sinks::base_sink<std::mutex> {
 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    output_.write({line.data(), line.size()});
  }
  void flush_() override {}

  linux::LineOutput output_{STDERR_FILENO};
};

void log_to_standard_error() {
  auto logger = std::make_shared<spdlog::logger>("thimbled", std::make_shared<StandardErrorSink>());
  logger->set_pattern("%l: %v");
  spdlog::set_default_logger(std::move(logger));
}

// Leaves what is there. Not a pipe that nobody reads: opening it would last for ever.
bool can_be_written(const std::optional<std::string>& path) {
  if (!path) return true;
  constexpr int kHow = O_WRONLY | O_CREAT | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
  const int file = ::open(path->c_str(), kHow, 0666);
  if (file < 0) return false;
  ::close(file);
  return true;
}

// Replaces what is there; writes nothing when there is no place.
bool write_summary(const std::optional<std::string>& path, const std::string& text) {
  if (!path) return true;
  std::ofstream file(*path, std::ios::trunc);
  file << text;
  file.close();
  return !file.fail();
}

// Once signals have their handlers, a word for which there is no room must not keep the process.
void say_without_waiting(const std::string& text) {
  linux::LineOutput(STDERR_FILENO).write("thimbled: " + text + "\n");
}

// The arms are at rest, but signals still have their handlers: a place that takes nothing (a pipe
// that nobody reads) would keep the process for ever.
bool write_last_summary(const std::optional<std::string>& path, const std::string& text) {
  const auto is_written = std::make_shared<std::atomic<bool>>(false);
  linux::BackgroundWorker worker;
  worker.post([=] { *is_written = write_summary(path, text); });
  if (worker.wait(kSummaryPatience) && *is_written) return true;
  say_without_waiting("the summary could not be written to " + path.value_or(""));
  return false;
}

int serve(Daemon& daemon, const Options& options, const linux::RealtimeProcess& process) {
  const Result<void> started = daemon.start(process);
  if (!started) {
    say_without_waiting(started.error().message);
    return kExitFailure;
  }
  const Result<void> ended = daemon.run();
  const std::string summary = api::to_json(daemon.final_status());
  const bool is_written = write_last_summary(options.summary, summary);
  return ended && is_written ? kExitOk : kExitFailure;
}

int run_checked(const Options& options) {
  session::Plugins plugins;
  const config::ConfigResult config =
      config::load(options.config, options.overrides, [&](const config::Config& said) {
        std::vector<config::Objection> all = session::inspect_with_plugins(said, plugins);
        if (!options.is_check) return all;
        const auto of_files = session::inspect_files(said, plugins.drivers);
        all.insert(all.end(), of_files.begin(), of_files.end());
        return all;
      });
  if (!config) {
    for (const config::ConfigError& error : config.error()) {
      std::fprintf(stderr, "%s\n", to_string(error).c_str());
    }
    return kExitUsage;
  }
  for (const std::string& doubt : session::doubts_of(*config, plugins.drivers)) {
    spdlog::warn("{}", doubt);
  }
  if (options.is_check) {
    std::printf("%s: the configuration is good\n", options.config.c_str());
    return kExitOk;
  }
  // A place that cannot be written is told before an experiment, not after it; what an earlier one
  // left there stays until there is something better.
  if (!can_be_written(options.summary)) {
    say_without_waiting("the summary could not be written to " + *options.summary);
    return kExitFailure;
  }
  // Before any other thread exists: it sets the size of their stacks and locks their memory.
  const linux::RealtimeProcess process;
  Daemon daemon(*config, options, plugins);
  const int code = serve(daemon, options, process);
  const Result<void> closed = daemon.close(kClosingPatience);
  if (closed) return code;
  // No force is on any arm, and all is written. What hangs uses what would be destroyed here.
  say_without_waiting(closed.error().message);
  ::_exit(code);
}

}  // namespace

int run(const Options& options) {
  // A closed pipe behind standard error must not end the process with a force on the arm.
  std::signal(SIGPIPE, SIG_IGN);
  log_to_standard_error();
  try {
    return run_checked(options);
  } catch (const std::exception& error) {
    say_without_waiting(error.what());
    return kExitFailure;
  }
}

int finish(int code) {
  const Result<void> written = linux::flush_standard_output();
  if (written) return code;
  say_without_waiting(written.error().message);
  return code == kExitOk ? kExitFailure : code;
}

}  // namespace thimble::app
