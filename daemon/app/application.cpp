#include "daemon/app/application.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>

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
  logger->set_pattern("%L %v");
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
}

bool write_summary(const std::string& path, const api::Status& status) {
  std::ofstream file(path, std::ios::trunc);
  file << api::to_json(status);
  file.close();
  if (file) return true;
  std::fprintf(stderr, "thimbled: the summary could not be written to %s\n", path.c_str());
  return false;
}

int run_checked(const Options& options) {
  const session::Plugins plugins;
  const session::RigParts parts{plugins.models, plugins.drivers};
  const config::ConfigResult config =
      config::load(options.config, options.overrides,
                   [&](const config::Config& said) { return session::inspect(said, parts); });
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
  // Before any other thread exists: it sets the size of their stacks and locks their memory.
  const linux::RealtimeProcess process;
  Daemon daemon(*config, options);
  const Result<void> started = daemon.start(process);
  if (!started) {
    std::fprintf(stderr, "thimbled: %s\n", started.error().message.c_str());
    return kExitFailure;
  }
  daemon.run();
  if (options.summary && !write_summary(*options.summary, daemon.final_status())) {
    return kExitFailure;
  }
  return kExitOk;
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
