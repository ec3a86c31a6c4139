#include "cli/devices/devices.hpp"

#include <iostream>

#include "cli/commands.hpp"
#include "cli/devices/arm_tables.hpp"
#include "cli/devices/inventory.hpp"
#include "cli/devices/report.hpp"
#include "cli/doctor/load_plugins.hpp"
#include "cli/doctor/read_facts.hpp"
#include "daemon/session/plugins.hpp"
#include "hal/linux/udev_scan.hpp"

namespace thimble::devices_list {
int run_devices(const DevicesOptions& options) {
  session::Plugins plugins;
  if (!doctor::load_plugins(plugins, options.plugins)) return cli::kExitRefused;
  const doctor::Facts facts = doctor::read_facts(
      options.root, plugins.drivers, doctor::who_listens(options.root, options.socket_path));
  const bool is_this_machine = options.root == "/";
  const auto is_arm = [&](const bus::BusDeviceInfo& info) { return plugins.drivers.knows(info); };
  // First what is plugged in: that is what one looks for.
  std::vector<Entry> entries =
      is_this_machine ? plugged_in(linux::UdevScan(is_arm).devices(), facts, plugins.drivers)
                      : plugged_in(facts);
  const std::vector<Entry> models = simulated(plugins.models, plugins.drivers);
  entries.insert(entries.end(), models.begin(), models.end());
  const Result<api::Status> status = cli::daemon_status(options.socket_path);
  if (status) mark_users(entries, *status);
  const std::string daemon =
      status ? "the daemon at " + options.socket_path + " was asked what it uses"
             : status.error().message;
  switch (options.form) {
    case Form::Text:
      std::cout << render(entries, daemon);
      break;
    case Form::Json:
      std::cout << to_json(entries, daemon);
      break;
    case Form::Toml:
      std::cout << arm_tables(entries, status ? *status : api::Status{}, daemon);
      break;
  }
  return cli::kExitOk;
}

}  // namespace thimble::devices_list
