#include "daemon/app/application.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <optional>
#include <string>

#include "daemon/app/daemon.hpp"
#include "daemon/app/exit_code.hpp"
#include "daemon/config/load.hpp"
#include "daemon/session/inspect.hpp"
#include "daemon/session/plugins.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/standard_streams.hpp"

namespace thimble::app {
namespace {

void log_to_standard_error() {
  auto logger = std::make_shared<spdlog::logger>("thimbled",
                                                 std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%l: %v");
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

// Writes nothing when there is no place. `how` leaves or replaces what is there.
bool write_summary(const std::optional<std::string>& path, std::ios::openmode how,
                   const std::string& text) {
  if (!path) return true;
  std::ofstream file(*path, how);
  file << text;
  file.close();
  if (file) return true;
  std::fprintf(stderr, "thimbled: the summary could not be written to %s\n", path->c_str());
  return false;
}

int run_checked(const Options& options) {
  session::Plugins plugins;
  const config::ConfigResult config =
      config::load(options.config, options.overrides, [&plugins](const config::Config& said) {
        return session::inspect_with_plugins(said, plugins);
      });
  if (!config) {
    for (const config::ConfigError& error : config.error()) {
      std::fprintf(stderr, "%s\n", to_string(error).c_str());
    }
    return kExitUsage;
  }
  if (options.is_check) {
    std::printf("%s: the configuration is good\n", options.config.c_str());
    return kExitOk;
  }
  // A place that cannot be written is told before an experiment, not after it; what an earlier one
  // left there stays until there is something better.
  if (!write_summary(options.summary, std::ios::app, "")) return kExitFailure;
  // Before any other thread exists: it sets the size of their stacks and locks their memory.
  const linux::RealtimeProcess process;
  Daemon daemon(*config, options, plugins);
  const Result<void> started = daemon.start(process);
  if (!started) {
    std::fprintf(stderr, "thimbled: %s\n", started.error().message.c_str());
    return kExitFailure;
  }
  daemon.run();
  const std::string summary = api::to_json(daemon.final_status());
  return write_summary(options.summary, std::ios::trunc, summary) ? kExitOk : kExitFailure;
}

}  // namespace

int run(const Options& options) {
  // A closed pipe behind standard error must not end the process with a force on the arm.
  std::signal(SIGPIPE, SIG_IGN);
  log_to_standard_error();
  try {
    return run_checked(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "thimbled: %s\n", error.what());
    return kExitFailure;
  }
}

int finish(int code) {
  const Result<void> written = linux::flush_standard_output();
  if (written) return code;
  std::fprintf(stderr, "thimbled: %s\n", written.error().message.c_str());
  return code == kExitOk ? kExitFailure : code;
}

}  // namespace thimble::app
