#include "daemon/app/application.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "daemon/app/daemon.hpp"
#include "daemon/app/exit_code.hpp"
#include "daemon/app/inspect_places.hpp"
#include "daemon/app/summary_file.hpp"
#include "daemon/config/load.hpp"
#include "daemon/config/report.hpp"
#include "daemon/session/inspect.hpp"
#include "daemon/session/plugins.hpp"
#include "hal/linux/line_output.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/standard_streams.hpp"

namespace thimble::app {
namespace {

// Ours; with those of recordings, 10 s, they are within TimeoutStopSec= of the unit.
constexpr Duration kClosingPatience = std::chrono::seconds(5);

// A log that nobody reads must not hold up the thread that looks after the arms.
class StandardErrorSink final : public spdlog::sinks::base_sink<std::mutex> {
 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t line;
    formatter_->format(message, line);
    const std::string_view text(line.data(), line.size());
    // Paths and names of a configuration are in it.
    output_.write(config::escaped(text.substr(0, text.find_last_not_of('\n') + 1)) + "\n");
  }
  void flush_() override {}

  linux::LineOutput output_{STDERR_FILENO};
};

void log_to_standard_error() {
  auto logger = std::make_shared<spdlog::logger>("thimbled", std::make_shared<StandardErrorSink>());
  logger->set_pattern("%l: %v");
  spdlog::set_default_logger(std::move(logger));
}

// Once signals have their handlers, a word for which there is no room must not keep the process.
void say_without_waiting(const std::string& text) {
  linux::LineOutput(STDERR_FILENO).write("thimbled: " + config::escaped(text) + "\n");
}

int serve(Daemon& daemon, SummaryFile& summary, const linux::RealtimeProcess& process) {
  const Result<void> started = daemon.start(process);
  if (!started) {
    summary.leave_out();
    say_without_waiting(started.error().message);
    return kExitFailure;
  }
  const Result<void> ended = daemon.run();
  const Result<void> written = summary.write(api::to_json(daemon.final_status()));
  if (!written) say_without_waiting(written.error().message);
  return ended && written ? kExitOk : kExitFailure;
}

void append(std::vector<config::Objection>& all, const std::vector<config::Objection>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

int run_checked(const Options& options) {
  session::Plugins plugins;
  const config::ConfigResult config =
      config::load(options.config, options.overrides, [&](const config::Config& said) {
        std::vector<config::Objection> all = session::inspect_with_plugins(said, plugins);
        append(all, inspect_socket(said));
        if (!options.is_check) return all;
        append(all, inspect_recordings(said));
        append(all, session::inspect_files(said, plugins.drivers));
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
  std::error_code ignored;
  if (options.summary && std::filesystem::equivalent(*options.summary, options.config, ignored)) {
    say_without_waiting("--summary names the configuration, which it would replace");
    return kExitUsage;
  }
  // A place that cannot be written is told before an experiment, not after it.
  SummaryFile summary(options.summary);
  if (const Result<void> prepared = summary.prepare(); !prepared) {
    say_without_waiting(prepared.error().message);
    return kExitFailure;
  }
  // Before any other thread exists: it sets the size of their stacks and locks their memory.
  const linux::RealtimeProcess process;
  Daemon daemon(*config, options, plugins);
  const int code = serve(daemon, summary, process);
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
  // Nor may a limit of the size of files: what is not written is said.
  std::signal(SIGXFSZ, SIG_IGN);
  log_to_standard_error();
  try {
    return run_checked(options);
  } catch (const std::bad_alloc&) {
    say_without_waiting("there is not enough memory");
    return kExitFailure;
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
