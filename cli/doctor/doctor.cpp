#include "cli/doctor/doctor.hpp"

#include <iostream>
#include <optional>
#include <utility>

#include "cli/commands.hpp"
#include "cli/doctor/checks.hpp"
#include "cli/doctor/load_plugins.hpp"
#include "cli/doctor/read_facts.hpp"
#include "cli/doctor/report.hpp"
#include "cli/text.hpp"
#include "daemon/config/load.hpp"
#include "daemon/config/paths.hpp"

namespace thimble::doctor {
namespace {

// The defaults where no file is named; nothing, once every mistake of the file has been told.
std::optional<config::Config> configuration(const std::string& file) {
  if (file.empty()) return config::Config{};
  config::ConfigResult loaded = config::load(file);
  if (loaded) return *std::move(loaded);
  for (const config::ConfigError& error : loaded.error()) {
    std::cerr << "thimble: " << cli::plain(config::to_string(error)) << '\n';
  }
  return std::nullopt;
}

std::string socket_of(const DoctorOptions& options, const config::Config& config) {
  if (!options.socket_path.empty()) return options.socket_path;
  return config.daemon.socket.value_or(config::default_socket_path(config::process_environment()));
}

}  // namespace

int run_doctor(const DoctorOptions& options) {
  const std::optional<config::Config> config = configuration(options.config);
  if (!config) return cli::kExitRefused;
  std::vector<std::string> paths = options.plugins;
  paths.insert(paths.end(), config->daemon.plugins.begin(), config->daemon.plugins.end());
  session::Plugins plugins;
  if (!load_plugins(plugins, paths)) return cli::kExitRefused;
  const DaemonAtSocket daemon = who_listens(options.root, socket_of(options, *config));
  const std::vector<Verdict> verdicts =
      examine(read_facts(options.root, plugins.drivers, daemon, *config));
  std::cout << (options.is_json ? to_json(verdicts) : render(verdicts));
  return is_something_wrong(verdicts) ? cli::kExitRefused : cli::kExitOk;
}

}  // namespace thimble::doctor
