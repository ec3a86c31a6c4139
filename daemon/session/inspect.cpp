#include "daemon/session/inspect.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/config/report.hpp"
#include "daemon/devices/open_arm.hpp"
#include "daemon/link/link_key.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/combination.hpp"
#include "daemon/session/real_arm_check.hpp"
#include "daemon/session/stand_in.hpp"
#include "daemon/session/world_settings.hpp"
#include "daemon/world/fields/field_world.hpp"
#include "daemon/world/io/field_file.hpp"
#include "daemon/world/io/mesh_file.hpp"
#include "daemon/world/io/world_source.hpp"
#include "drivers/falcon/find_model.hpp"
#include "hal/bus/device_address.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::session {
namespace {

using config::Objection;

// Any that every driver takes; to learn whether it is the current that a driver dislikes.
constexpr double kHarmlessCurrent_a = 1;

// Of all drivers; nothing where one cannot tell.
std::optional<std::vector<std::string>> known_models(const plugin::DriverRegistry& drivers) {
  std::vector<std::string> all;
  for (const auto& driver : drivers.drivers()) {
    const std::vector<std::string> models = driver->models();
    if (models.empty()) return std::nullopt;
    all.insert(all.end(), models.begin(), models.end());
  }
  return all;
}

bool may_drive(const plugin::Driver& driver, const config::ArmConfig& arm) {
  if (!arm.model) return true;
  const std::vector<std::string> models = driver.models();
  return std::find(models.begin(), models.end(), *arm.model) != models.end();
}

// Hardware that ends a force where no program does.
bool has_cut(const config::Config& config) {
  return config.safety && config.safety->enable && !bus::is_simulated(config.safety->chip);
}

bool is_falcon(const config::ArmConfig& arm) {
  if (bus::is_simulated(arm.device)) return false;
  return arm.model ? falcon::find_model(*arm.model) != nullptr : arm.device.starts_with("usb:");
}

// A simulated Falcon forgets its firmware as a real one does; "sim:falcon-loaded" has some.
bool is_unloaded_falcon(const config::ArmConfig& arm) {
  return bus::simulated_model(arm.device) == falcon::kFalconModels.front().name && !arm.firmware;
}

// As the pages write one that a person has to replace.
void doubt_copied_device(const config::ArmConfig& arm, std::vector<std::string>& out) {
  if (!arm.device.ends_with(":SERIAL") && !arm.device.ends_with(":PORT")) return;
  out.push_back("arm '" + arm.name + "' has the device " + arm.device +
                ", which stands in the pages for yours: thimble devices lists it");
}

// Of a Falcon under the driver of the house.
void doubt_our_falcon(const config::Config& config, const config::ArmConfig& arm,
                      std::vector<std::string>& out) {
  if (is_unloaded_falcon(arm)) {
    out.push_back("arm '" + arm.name + "' lacks " + std::string(kFalconWantsFirmware) +
                  "; without a firmware file use sim:falcon-loaded");
  }
  if (!is_falcon(arm)) return;
  if (!arm.firmware) {
    out.push_back("arm '" + arm.name + "' lacks " + std::string(kFalconWantsFirmware));
  }
  if (config.servo.rate_hz && *config.servo.rate_hz < falcon::kFullRate_hz) {
    out.push_back("arm '" + arm.name +
                  "' does not give all of its 1000 samples a second at servo.rate_hz = " +
                  std::to_string(std::lround(*config.servo.rate_hz)) +
                  ": a Falcon takes 1.3 ms to answer, and the tick that sees it asks for the "
                  "next; leave servo.rate_hz out to have them all, or set 4000");
  }
}

class ArmInspection {
 public:
  // `is_whole`: there are no models and drivers but these.
  ArmInspection(const config::Config& config, std::size_t index, const RigParts& parts,
                bool is_whole)
      : servo_(config.servo),
        arm_(config.arms[index]),
        index_(index),
        parts_(parts),
        is_whole_(is_whole) {}

  [[nodiscard]] std::vector<Objection> run() && {
    if (arm_.device.empty()) return {};
    if (is_whole_) inspect_without_device();
    if (!has_objection("device")) inspect_device();
    return std::move(objections_);
  }

 private:
  void object(std::string key, std::string message) {
    objections_.push_back({Objection::Table::Arm, index_, std::move(key), std::move(message)});
  }

  void inspect_without_device() {
    for (KeyRefusal& refusal : refusals_of_real(arm_, parts_.drivers)) {
      object(std::move(refusal.key), std::move(refusal.message));
    }
  }

  [[nodiscard]] bool has_objection(std::string_view key) const {
    return std::any_of(objections_.begin(), objections_.end(),
                       [&](const Objection& objection) { return objection.key == key; });
  }

  void inspect_device() {
    if (arm_.fallback == config::Fallback::Simulated) {
      const Result<config::ArmConfig> simulated = stand_in_for(arm_, parts_.models);
      if (!simulated && !is_whole_) return;
      if (!simulated) return object("fallback", simulated.error().message);
      arm_ = *simulated;  // what is wrong with it is wrong with the real one
    }
    const std::string_view address = arm_.device;
    for (const std::string_view scheme : {"hid:", "usb:", "serial:"}) {
      if (address.starts_with(scheme)) return inspect_real();
    }
    if (!bus::is_simulated(address)) {
      const std::string bus = arm_.device.substr(0, arm_.device.find(':'));
      return object("device",
                    "expected a device such as \"sim:phantom-vintage\" or \"hid:SERIAL\", since " +
                        ("this version has no " + bus) + " bus yet; found " +
                        config::in_quotes(arm_.device));
    }
    const plugin::SimModelEntry* entry = parts_.models.find(bus::simulated_model(address));
    if (entry == nullptr && !is_whole_) return;
    if (entry == nullptr) {
      std::string known;
      for (const auto& model : parts_.models.entries()) known += " sim:" + model.name;
      return object("device",
                    "expected one of" + known + "; found " + config::in_quotes(arm_.device));
    }
    const std::size_t before = objections_.size();
    inspect_settings(*entry);
    if (objections_.size() == before) inspect_session();
  }

  // Plugged in or not: what is wrong with the configuration of a real arm shall be known before
  // the arm comes. A simulated one of its model has the same limits.
  void inspect_real() {
    if (!arm_.model) return inspect_unnamed();
    if (Result<config::ArmConfig> simulated = stand_in_for(arm_, parts_.models)) {
      simulated->newton_per_count = arm_.newton_per_count;  // whether it can be is looked at, too
      arm_ = *std::move(simulated);
      return inspect_device();
    }
    const std::optional<std::vector<std::string>> known = known_models(parts_.drivers);
    if (!is_whole_ || !known ||
        std::find(known->begin(), known->end(), *arm_.model) != known->end()) {
      return;
    }
    std::string names;
    for (const std::string& name : *known) names += " " + name;
    object("model", "expected one of" + names + "; found " + config::in_quotes(*arm_.model));
  }

  // A puck or a Falcon tells what it is; what has amplifiers of unknown size does not.
  void inspect_unnamed() {
    if (!arm_.amplifier_max_a || !known_models(parts_.drivers)) return;
    if (has_objection("amplifier_max_a")) return;
    object("model",
           "expected beside amplifier_max_a: the controller does not tell which arm it drives");
  }

  [[nodiscard]] Result<void> match(const plugin::SimModelEntry& entry,
                                   const config::ArmConfig& arm) const {
    const auto model = entry.create({});
    if (!model) return tl::unexpected(model.error());
    bus::BusDeviceInfo info = plugin::describe(*model);
    info.address = {arm.device};
    const auto driver = parts_.drivers.match(info, driver_settings(arm));
    if (!driver) return tl::unexpected(driver.error());
    return {};
  }

  // A driver names the first thing that it dislikes: which key that is shows in what it says when
  // the key is put right; then the next.
  void inspect_settings(const plugin::SimModelEntry& entry) {
    config::ArmConfig arm = arm_;
    Result<void> matched = match(entry, arm);
    const auto try_without = [&](std::string key, const config::ArmConfig& changed) {
      if (matched) return;
      Result<void> now = match(entry, changed);
      if (!now && now.error() == matched.error()) return;
      object(std::move(key), matched.error().message);
      arm = changed;
      matched = std::move(now);
    };
    config::ArmConfig changed = arm;
    changed.amplifier_max_a = kHarmlessCurrent_a;
    try_without("amplifier_max_a", changed);
    changed = arm;
    changed.model.reset();
    try_without("model", changed);
    changed = arm;
    changed.newton_per_count.reset();
    try_without("newton_per_count", changed);
    if (!matched) object("device", matched.error().message);
  }

  // What keeps the arm from being opened: its firmware, if it opens without.
  template <class Open>
  [[nodiscard]] std::string key_of_refusal(const Open& open) const {
    config::ArmConfig without = arm_;
    without.firmware.reset();
    without.firmware_sha256.reset();
    return arm_.firmware && open(without) ? "firmware" : "device";
  }

  // The session as it would be made, but for its link: on a simulated bus nothing is touched.
  void inspect_session() {
    const auto sim_arm = SimArm::create(parts_.models, arm_);
    if (!sim_arm) return object("hand", sim_arm.error().message);
    const auto open = [&](const config::ArmConfig& arm) {
      plugin::DriverSettings settings = driver_settings(arm);
      settings.clock = &(*sim_arm)->clock();
      return devices::open_arm((*sim_arm)->buses(), parts_.drivers, {arm.device}, settings);
    };
    const auto device = open(arm_);
    if (!device) return object(key_of_refusal(open), device.error().message);
    const auto settings = servo_settings(arm_, servo_, (*device)->capabilities());
    if (!settings) object("limits", settings.error().message);
    const auto coupling = make_coupling(arm_, 0, (*device)->capabilities());
    if (!coupling) object("coupling", coupling.error().message);
  }

  const config::ServoConfig& servo_;
  config::ArmConfig arm_;
  std::size_t index_;
  const RigParts& parts_;
  bool is_whole_;
  std::vector<Objection> objections_;
};

// What does not go with a world of this kind.
void inspect_beside(const config::Config& config, std::size_t index, const world::World& world,
                    std::vector<Objection>& out) {
  const config::WorldConfig& said = config.worlds[index];
  if (const auto refusal = find_refusal(world, said)) {
    out.push_back({Objection::Table::World, index, refusal->key, refusal->reason});
  }
  for (std::size_t i = 0; i < config.arms.size(); ++i) {
    if (config.arms[i].world != said.name) continue;
    if (const auto refusal = find_refusal(world, config.arms[i].coupling)) {
      // The arm's own table knows "coupling", not what is below it.
      out.push_back({Objection::Table::Arm, i, "coupling", refusal->reason});
    }
  }
}

// A world without a grid costs little to make, so whether it goes with what is said is seen at
// once; one with a grid goes with everything.
void inspect_made(const config::Config& config, std::size_t index, std::vector<Objection>& out) {
  const config::WorldConfig& said = config.worlds[index];
  sim::VirtualClock clock;
  sim::SimEnumerator none(clock);  // a board may come later
  devices::InlineExecutor executor;
  const Result<MadeWorld> made =
      make_world(said, &clock, {&none, &executor, [] { return fail(Errc::NotFound, "none"); }});
  if (!made) return out.push_back({Objection::Table::World, index, "source", made.error().message});
  inspect_beside(config, index, *made->world, out);
}

// A field may be large: its file is looked at, and the smallest of all stands in for the rest.
void inspect_field(const config::Config& config, std::size_t index, std::vector<Objection>& out) {
  const config::WorldConfig& said = config.worlds[index];
  const auto checked = said.field->is_mesh
                           ? world::check_mesh_file(said.source)
                           : world::check_field_file(said.source, field_options(said));
  if (!checked) {
    return out.push_back({Objection::Table::World, index, "source", checked.error().message});
  }
  auto least = world::DistanceField::create({2, 2, 2}, 1, std::vector<float>(8, 1));
  if (least) inspect_beside(config, index, world::FieldWorld(*std::move(least), said.source), out);
}

}  // namespace

std::vector<Objection> inspect(const config::Config& config, const RigParts& parts, bool is_whole) {
  std::vector<Objection> out;
  for (std::size_t i = 0; i < config.arms.size(); ++i) {
    for (Objection& objection : ArmInspection(config, i, parts, is_whole).run()) {
      out.push_back(std::move(objection));
    }
  }
  for (std::size_t i = 0; i < config.worlds.size(); ++i) {
    const config::WorldConfig& said = config.worlds[i];
    if (said.source.empty()) continue;
    if (said.sphere || said.block || !said.shapes.empty() || said.pieces || said.automaton) {
      inspect_made(config, i, out);
      continue;
    }
    if (said.field) {
      inspect_field(config, i, out);
      continue;
    }
    const Result<void> checked = world::check_world(said.source, volume_options(said));
    if (!checked) out.push_back({Objection::Table::World, i, "source", checked.error().message});
  }
  return out;
}

namespace {

template <class Said>
void inspect_keys(const std::vector<Said>& said, Objection::Table table,
                  std::vector<Objection>& out) {
  for (std::size_t i = 0; i < said.size(); ++i) {
    if (!said[i].key_file) continue;
    const Result<link::LinkKey> key = link::load_key(*said[i].key_file);
    if (!key) out.push_back({table, i, "key_file", key.error().message});
  }
}

}  // namespace

std::vector<Objection> inspect_files(const config::Config& config,
                                     const plugin::DriverRegistry& drivers) {
  std::vector<Objection> out;
  inspect_keys(config.arms, Objection::Table::Arm, out);
  inspect_keys(config.worlds, Objection::Table::World, out);
  if (!known_models(drivers)) return out;  // the device may be that of a plugin, and so the file
  for (std::size_t i = 0; i < config.arms.size(); ++i) {
    const config::ArmConfig& arm = config.arms[i];
    if (arm.device.empty() || bus::is_simulated(arm.device)) continue;
    for (const auto& driver : drivers.drivers()) {
      if (!may_drive(*driver, arm)) continue;
      const Result<void> checked = driver->check_files(driver_settings(arm));
      if (checked) continue;
      out.push_back({Objection::Table::Arm, i, "firmware", checked.error().message});
    }
  }
  return out;
}

std::vector<std::string> doubts_of(const config::Config& config,
                                   const plugin::DriverRegistry& drivers) {
  std::vector<std::string> out;
  const bool is_sure = known_models(drivers).has_value();
  for (const config::ArmConfig& arm : config.arms) {
    if (is_sure && !drivers.is_from_outside("falcon")) doubt_our_falcon(config, arm, out);
    doubt_copied_device(arm, out);
    // Whoever drives it.
    if (is_falcon(arm) && (is_sure || arm.model) && !has_cut(config)) {
      out.push_back("arm '" + arm.name + "' " + std::string(kFalconKeepsForce));
    }
  }
  return out;
}

std::vector<Objection> inspect_with_plugins(const config::Config& config, Plugins& plugins) {
  std::string refused;  // of one key there is one objection
  for (const Error& error : plugins.load(config.daemon.plugins)) {
    refused += (refused.empty() ? "" : "; ") + error.message;
  }
  std::vector<Objection> out = inspect(config, {plugins.models, plugins.drivers}, refused.empty());
  if (!refused.empty()) out.push_back({Objection::Table::Daemon, 0, "plugins", refused});
  return out;
}

}  // namespace thimble::session
