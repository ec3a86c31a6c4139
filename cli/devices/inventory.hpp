#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/doctor/facts.hpp"
#include "daemon/api/status.hpp"
#include "hal/linux/udev_scan.hpp"
#include "hal/plugin/driver_registry.hpp"
#include "hal/plugin/sim_model.hpp"

namespace thimble::devices_list {

// Which keys a configuration has to have of an arm besides `device`.
struct NeededKeys {
  bool model{false};  // the device does not tell which arm it is
  bool amplifier_max_a{false};
  bool is_too_low_harmless{false};  // that of an amplifier: it weakens the arm
  bool firmware{false};
  bool limits{false};  // it makes force
  bool operator==(const NeededKeys&) const = default;
};

// One thing that `arm.device` of a configuration could name.
struct Entry {
  std::string address;
  std::string description;
  std::string obstacle;               // why it cannot be used; empty: it can
  std::string needs;                  // what a configuration must say of it besides; may be empty
  std::vector<std::string> users;     // arms of the running daemon, "right (active)"
  std::vector<std::string> models{};  // that arm.model may name for it, of what is plugged in
  bool is_plugged_in_arm{false};      // one that a driver knows
  NeededKeys keys{};                  // of such a one
  bool operator==(const Entry&) const = default;
};

// The simulated ones, each tried with the drivers as a daemon would.
[[nodiscard]] std::vector<Entry> simulated(const plugin::SimModelRegistry& models,
                                           const plugin::DriverRegistry& drivers);
// What is plugged into this machine, of which `facts` tell, too: also what no driver knows.
[[nodiscard]] std::vector<Entry> plugged_in(std::span<const linux::FoundDevice> devices,
                                            const doctor::Facts& facts,
                                            const plugin::DriverRegistry& drivers);
// What is plugged into a machine that is known by its facts only: the arms.
[[nodiscard]] std::vector<Entry> plugged_in(const doctor::Facts& facts);
// Writes down who uses what; a device in use that is not listed yet is added.
void mark_users(std::vector<Entry>& entries, const api::Status& status);

}  // namespace thimble::devices_list
