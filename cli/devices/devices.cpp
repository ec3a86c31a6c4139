#include "cli/devices/devices.hpp"

#include <iostream>

#include "cli/commands.hpp"
#include "cli/devices/inventory.hpp"
#include "cli/devices/report.hpp"
#include "cli/doctor/load_plugins.hpp"
#include "cli/doctor/read_facts.hpp"
#include "daemon/session/plugins.hpp"

namespace thimble::devices_list {
int run_devices(const DevicesOptions& options) {
  session::Plugins plugins;
  if (!doctor::load_plugins(plugins, options.plugins)) return cli::kExitRefused;
  std::vector<Entry> entries = simulated(plugins.models, plugins.drivers);
  const std::vector<Entry> real = plugged_in(doctor::read_facts(
      options.root, plugins.drivers, doctor::who_listens(options.root, options.socket_path)));
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
