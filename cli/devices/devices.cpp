#include "cli/devices/devices.hpp"

#include <filesystem>
#include <iostream>

#include "cli/commands.hpp"
#include "cli/devices/inventory.hpp"
#include "cli/devices/report.hpp"
#include "cli/doctor/read_facts.hpp"
#include "cli/text.hpp"
#include "daemon/session/plugins.hpp"

namespace thimble::devices_list {
namespace {

// Typed on a command line, a path means the place where it is typed.
std::vector<std::string> absolute(std::vector<std::string> paths) {
  for (std::string& path : paths) path = std::filesystem::absolute(path).string();
  return paths;
}

}  // namespace

int run_devices(const DevicesOptions& options) {
  session::Plugins plugins;
  const std::vector<Error> refused = plugins.load(absolute(options.plugins));
  for (const Error& error : refused) std::cerr << "thimble: " << cli::plain(error.message) << '\n';
  if (!refused.empty()) return cli::kExitRefused;
  std::vector<Entry> entries = simulated(plugins.models, plugins.drivers);
  const std::vector<Entry> real = plugged_in(doctor::read_facts(options.root));
  entries.insert(entries.end(), real.begin(), real.end());
  const Result<api::Status> status = cli::daemon_status(options.socket_path);
  if (status) mark_users(entries, *status);
  const std::string daemon =
      status ? "the daemon at " + options.socket_path + " was asked what it uses"
             : status.error().message;
  std::cout << (options.is_json ? to_json(entries, daemon) : render(entries, daemon));
  return cli::kExitOk;
}

}  // namespace thimble::devices_list
