#include "cli/doctor/doctor.hpp"

#include <iostream>

#include "cli/commands.hpp"
#include "cli/doctor/checks.hpp"
#include "cli/doctor/file_tree.hpp"
#include "cli/doctor/load_plugins.hpp"
#include "cli/doctor/read_configuration.hpp"
#include "cli/doctor/read_facts.hpp"
#include "cli/doctor/report.hpp"
#include "daemon/config/paths.hpp"

namespace thimble::doctor {
namespace {

std::string socket_of(const DoctorOptions& options, const config::Config& config) {
  if (!options.socket_path.empty()) return options.socket_path;
  return config.daemon.socket.value_or(config::default_socket_path(config::process_environment()));
}

}  // namespace

int run_doctor(const DoctorOptions& options) {
  session::Plugins plugins;
  if (!load_plugins(plugins, options.plugins)) return cli::kExitRefused;
  const ReadConfiguration read =
      read_configuration(FileTree(options.root), options.root, options.config, plugins);
  const DaemonAtSocket daemon = who_listens(options.root, socket_of(options, read.config));
  Facts facts = read_facts(options.root, plugins.drivers, daemon, read.config);
  if (is_this_machine(options.root)) facts.service = cli::read_service_state();
  facts.configuration = read.about;
  const std::vector<Verdict> verdicts = examine(facts);
  std::cout << (options.is_json ? to_json(verdicts) : render(verdicts));
  return is_something_wrong(verdicts) ? cli::kExitRefused : cli::kExitOk;
}

}  // namespace thimble::doctor
