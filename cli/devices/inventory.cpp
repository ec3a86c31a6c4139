#include "cli/devices/inventory.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "cli/doctor/checks.hpp"
#include "daemon/session/inspect.hpp"

namespace thimble::devices_list {
namespace {

// Any full scale that a driver takes: whether that is all it lacks.
constexpr double kSomeCurrent_a = 1;

Entry simulated_entry(const plugin::SimModelEntry& model, const plugin::DriverRegistry& drivers) {
  Entry entry{"sim:" + model.name, model.description, "", "", {}};
  const auto made = model.create({});
  if (!made) {
    entry.obstacle = made.error().message;
    return entry;
  }
  bus::BusDeviceInfo info = plugin::describe(*made);
  info.address = {entry.address};
  plugin::DriverSettings settings;
  const auto bare = drivers.match(info, settings);
  if (bare) return entry;
  settings.amplifier_max_a = kSomeCurrent_a;
  if (const auto driver = drivers.match(info, settings); !driver) {
    entry.obstacle = driver.error().code == Errc::NotFound
                         ? "no driver knows it: " + driver.error().message
                         : driver.error().message;
    return entry;
  }
  entry.needs = bare.error().message;
  return entry;
}

// Empty when nothing is in the way.
std::string obstacles(const doctor::Facts& facts, const doctor::Controller& controller) {
  std::string all;
  std::vector<doctor::Verdict> verdicts{doctor::check_node(facts, controller),
                                        doctor::check_usb_speed(controller),
                                        doctor::check_holders(facts, controller)};
  for (const doctor::Node& node : controller.raw_nodes) {
    verdicts.push_back(doctor::check_raw_node(facts, controller, node));
  }
  for (const doctor::Verdict& verdict : verdicts) {
    if (verdict.level != doctor::Level::Wrong) continue;
    all += (all.empty() ? "" : "; ") + verdict.finding;
  }
  return all.empty() ? all : all + " (thimble doctor says what mends it)";
}

std::string description_of(const linux::FoundDevice& device) {
  const bus::BusDeviceInfo& info = device.info;
  std::array<char, 16> ids{};
  std::snprintf(ids.data(), ids.size(), "%04x:%04x", static_cast<unsigned>(info.vendor_id),
                static_cast<unsigned>(info.product_id));
  std::string text = info.manufacturer;
  if (!info.product.empty()) text += (text.empty() ? "" : " ") + info.product;
  return text + (text.empty() ? "" : ", ") + ids.data() + " at " + device.node;
}

// What a configuration must say before a driver takes it: as the driver says it, first of a device
// that nobody has named, then of one that is named and no more.
std::string needs_of(const bus::BusDeviceInfo& info, const plugin::DriverRegistry& drivers) {
  plugin::DriverSettings settings;
  const auto unnamed = drivers.match(info, settings);
  settings.is_named_by_person = true;
  const auto named = drivers.match(info, settings);
  if (named && (*named)->name() == "falcon" && !drivers.is_from_outside("falcon")) {
    return std::string(session::kFalconWantsFirmware);
  }
  std::string needs = unnamed ? "" : unnamed.error().message;
  if (!named && named.error().message != needs) needs += "; " + named.error().message;
  return needs;
}

// Each that the device's driver takes for it: the controller itself may not tell which arm it has.
std::vector<std::string> models_of(const bus::BusDeviceInfo& info,
                                   const plugin::DriverRegistry& drivers) {
  std::vector<std::string> taken;
  plugin::DriverSettings settings;
  settings.is_named_by_person = true;
  settings.amplifier_max_a = kSomeCurrent_a;
  for (const auto& driver : drivers.drivers()) {
    for (const std::string& model : driver->models()) {
      settings.model = model;
      if (driver->probe(info, settings)) taken.push_back(model);
    }
  }
  return taken;
}

// Found out as a daemon would: by what its driver takes.
NeededKeys keys_of(const bus::BusDeviceInfo& info, const std::vector<std::string>& models,
                   const plugin::DriverRegistry& drivers) {
  NeededKeys keys{.limits = true};
  plugin::DriverSettings settings;
  settings.is_named_by_person = true;
  settings.amplifier_max_a = kSomeCurrent_a;
  keys.model = !drivers.match(info, settings) && !models.empty();
  if (keys.model) settings.model = models.front();
  const auto driver = drivers.match(info, settings);
  if (!driver) return keys;
  settings.amplifier_max_a.reset();
  keys.amplifier_max_a = !drivers.match(info, settings);
  // Also where a driver has a choice for the ids: an amplifier is no arm.
  keys.model = keys.model || (keys.amplifier_max_a && models.size() > 1);
  // Of those of the house the only one whose current follows from it.
  keys.is_too_low_harmless =
      keys.amplifier_max_a && (*driver)->name() == "phantom" && !drivers.is_from_outside("phantom");
  // One that cannot tell is bounded, too.
  const auto used = (*driver)->used_settings();
  keys.firmware = used && used->firmware;
  keys.limits = !used || used->amplifier_max_a || used->newton_per_count;
  return keys;
}

Entry real_entry(const linux::FoundDevice& device, const doctor::Facts& facts,
                 const plugin::DriverRegistry& drivers) {
  Entry entry{device.info.address.text, description_of(device), "", "", {}};
  if (!drivers.knows(device.info)) {
    const std::string why = drivers.objections(device.info);
    entry.obstacle = "no driver knows it" + (why.empty() ? "" : ": " + why);
    return entry;
  }
  entry.is_plugged_in_arm = true;
  entry.needs = needs_of(device.info, drivers);
  entry.models = models_of(device.info, drivers);
  entry.keys = keys_of(device.info, entry.models, drivers);
  for (const doctor::Controller& controller : facts.controllers) {
    if (controller.node.path == device.node) entry.obstacle = obstacles(facts, controller);
  }
  return entry;
}

}  // namespace

std::vector<Entry> simulated(const plugin::SimModelRegistry& models,
                             const plugin::DriverRegistry& drivers) {
  std::vector<Entry> entries;
  for (const auto& model : models.entries()) entries.push_back(simulated_entry(model, drivers));
  return entries;
}

std::vector<Entry> plugged_in(std::span<const linux::FoundDevice> devices,
                              const doctor::Facts& facts, const plugin::DriverRegistry& drivers) {
  std::vector<Entry> entries;
  for (const linux::FoundDevice& device : devices) {
    entries.push_back(real_entry(device, facts, drivers));
  }
  return entries;
}

std::vector<Entry> plugged_in(const doctor::Facts& facts) {
  std::vector<Entry> entries;
  for (const doctor::Controller& controller : facts.controllers) {
    entries.push_back({controller.address,
                       "controller at " + controller.node.path,
                       obstacles(facts, controller),
                       "",
                       {},
                       {},
                       true});
  }
  return entries;
}

void mark_users(std::vector<Entry>& entries, const api::Status& status) {
  for (const api::ArmStatus& arm : status.arms) {
    auto entry = std::find_if(entries.begin(), entries.end(),
                              [&](const Entry& known) { return known.address == arm.device; });
    if (entry == entries.end()) {
      const bool is_gone = arm.state == "lost";
      entry = entries.insert(entries.end(),
                             {arm.device, arm.model, is_gone ? "it is not there" : "", "", {}});
    }
    entry->users.push_back(arm.name + " (" + arm.state + ")");
  }
}

}  // namespace thimble::devices_list
