#include "daemon/session/real_arm_check.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "daemon/config/report.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/bus/device_address.hpp"
#include "hal/bus/device_name.hpp"

namespace thimble::session {
namespace {

// On which a real arm may be.
constexpr std::array kKinds{bus::BusKind::Hid, bus::BusKind::Usb, bus::BusKind::Serial};

// As the addresses of its devices begin.
std::string scheme_of(bus::BusKind kind) { return std::string(bus::to_string(kind)) + ":"; }

using Kinds = std::vector<bus::BusKind>;

std::optional<bus::BusKind> kind_of(std::string_view address) {
  for (const bus::BusKind kind : kKinds) {
    if (address.starts_with(scheme_of(kind))) return kind;
  }
  return std::nullopt;
}

bool has(const Kinds& kinds, bus::BusKind kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

std::string schemes_of(const Kinds& kinds) {
  std::string all;
  for (const bus::BusKind kind : kKinds) {
    if (!has(kinds, kind)) continue;
    all += (all.empty() ? "" : " or ") + config::in_quotes(scheme_of(kind));
  }
  return all;
}

// A model that no driver has is another mistake.
std::optional<KeyRefusal> wrong_bus(const config::ArmConfig& arm, bus::BusKind kind,
                                    const plugin::DriverRegistry& drivers) {
  if (!arm.model) return std::nullopt;
  Kinds all;
  for (const auto& driver : drivers.drivers()) {
    const std::optional<Kinds> some = driver->buses_of(*arm.model);
    if (!some) return std::nullopt;
    all.insert(all.end(), some->begin(), some->end());
  }
  if (all.empty() || has(all, kind)) return std::nullopt;
  return KeyRefusal{"device", "expected an address that begins with " + schemes_of(all) +
                                  ", since nothing drives a '" + *arm.model +
                                  "' on another bus; found " + config::in_quotes(arm.device)};
}

// Those who may come to drive the arm, and all that any of them uses.
struct Candidates {
  std::string names;
  plugin::UsedSettings used{};
};

std::optional<Candidates> candidates_for(const config::ArmConfig& arm, bus::BusKind kind,
                                         const plugin::DriverRegistry& drivers) {
  Candidates out;
  for (const auto& driver : drivers.drivers()) {
    const std::optional<Kinds> kinds = driver->buses_of(arm.model.value_or(""));
    if (!kinds) return std::nullopt;
    if (!has(*kinds, kind)) continue;
    const std::optional<plugin::UsedSettings> used = driver->used_settings();
    if (!used) return std::nullopt;
    out.names += (out.names.empty() ? "" : ", ") + std::string(driver->name());
    out.used.amplifier_max_a |= used->amplifier_max_a;
    out.used.firmware |= used->firmware;
    out.used.newton_per_count |= used->newton_per_count;
  }
  return out.names.empty() ? std::nullopt : std::optional(out);
}

// Who wrote it believes that it is in force: a bound, or what a scale showed.
std::vector<KeyRefusal> unused_keys(const config::ArmConfig& arm, bus::BusKind kind,
                                    const plugin::DriverRegistry& drivers) {
  const std::optional<Candidates> found = candidates_for(arm, kind, drivers);
  if (!found) return {};
  std::vector<KeyRefusal> out;
  const auto refuse = [&](const std::string& key, bool is_said, bool is_used) {
    if (!is_said || is_used) return;
    out.push_back({key, found->names + ": " + key +
                            " is not a setting of this arm, and would do nothing; take it out"});
  };
  refuse("amplifier_max_a", arm.amplifier_max_a.has_value(), found->used.amplifier_max_a);
  refuse("firmware", arm.firmware.has_value(), found->used.firmware);
  refuse("firmware_sha256", arm.firmware_sha256.has_value(), found->used.firmware);
  refuse("newton_per_count", arm.newton_per_count.has_value(), found->used.newton_per_count);
  return out;
}

}  // namespace

std::vector<KeyRefusal> refusals_of_real(const config::ArmConfig& arm,
                                         const plugin::DriverRegistry& drivers) {
  if (bus::is_simulated(arm.device)) return {};
  if (!bus::is_device_address(arm.device)) {
    return {{"device",
             "no bus names a device so: a serial number or a port such as "
             "pci-0000:00:14.0-usb-0:4.2 follows \"hid:\", \"usb:\" and \"serial:\", as "
             "thimble devices lists it; found " +
                 config::in_quotes(arm.device)}};
  }
  const std::optional<bus::BusKind> kind = kind_of(arm.device);
  if (!kind) return {};
  if (const auto wrong = wrong_bus(arm, *kind, drivers)) return {*wrong};
  return unused_keys(arm, *kind, drivers);
}

}  // namespace thimble::session
