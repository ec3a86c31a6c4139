#include "cli/devices/inventory.hpp"

#include <algorithm>

#include "cli/doctor/checks.hpp"

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

std::string obstacles(const doctor::Facts& facts, const doctor::Controller& controller) {
  const std::string bus = controller.address.substr(0, controller.address.find(':'));
  std::string all = "this version has no " + bus + " bus yet";
  std::vector<doctor::Verdict> verdicts{doctor::check_node(facts, controller),
                                        doctor::check_usb_speed(controller),
                                        doctor::check_holders(facts, controller)};
  for (const doctor::Node& node : controller.raw_nodes) {
    verdicts.push_back(doctor::check_raw_node(facts, controller, node));
  }
  for (const doctor::Verdict& verdict : verdicts) {
    if (verdict.level == doctor::Level::Wrong) all += "; " + verdict.finding;
  }
  return all + " (thimble doctor says what mends it)";
}

}  // namespace

std::vector<Entry> simulated(const plugin::SimModelRegistry& models,
                             const plugin::DriverRegistry& drivers) {
  std::vector<Entry> entries;
  for (const auto& model : models.entries()) entries.push_back(simulated_entry(model, drivers));
  return entries;
}

std::vector<Entry> plugged_in(const doctor::Facts& facts) {
  std::vector<Entry> entries;
  for (const doctor::Controller& controller : facts.controllers) {
    entries.push_back({controller.address,
                       "controller at " + controller.node.path,
                       obstacles(facts, controller),
                       "",
                       {}});
  }
  return entries;
}

void mark_users(std::vector<Entry>& entries, const api::Status& status) {
  for (const api::ArmStatus& arm : status.arms) {
    auto entry = std::find_if(entries.begin(), entries.end(),
                              [&](const Entry& known) { return known.address == arm.device; });
    if (entry == entries.end()) {
      entry = entries.insert(entries.end(), {arm.device, arm.model, "", "", {}});
    }
    entry->users.push_back(arm.name + " (" + arm.state + ")");
  }
}

}  // namespace thimble::devices_list
