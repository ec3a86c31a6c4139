#include "daemon/session/sim_arm.hpp"

#include <string_view>

namespace thimble::session {
namespace {

sim::HandMotion motion_of(config::HandMotion motion) {
  switch (motion) {
    case config::HandMotion::Still:
      return sim::HandMotion::Still;
    case config::HandMotion::Poke:
      return sim::HandMotion::Poke;
    case config::HandMotion::Sweep:
      return sim::HandMotion::Sweep;
    case config::HandMotion::Circle:
      return sim::HandMotion::Circle;
    case config::HandMotion::Tremor:
      return sim::HandMotion::Tremor;
    case config::HandMotion::Explore:
      return sim::HandMotion::Explore;
  }
  return sim::HandMotion::Still;
}

sim::HandSettings hand_settings(const config::HandConfig& said) {
  sim::HandSettings settings;
  settings.motion = motion_of(said.motion);
  settings.seed = said.seed;
  settings.speed_m_per_s = said.speed_m_per_s.value_or(settings.speed_m_per_s);
  settings.reach_m = said.reach_m.value_or(settings.reach_m);
  settings.stiffness_newton_per_m =
      said.stiffness_newton_per_m.value_or(settings.stiffness_newton_per_m);
  settings.damping_newton_s_per_m =
      said.damping_newton_s_per_m.value_or(settings.damping_newton_s_per_m);
  settings.mass_kg = said.mass_kg.value_or(settings.mass_kg);
  return settings;
}

}  // namespace

Result<std::unique_ptr<SimArm>> SimArm::create(const plugin::SimModelRegistry& models,
                                               const config::ArmConfig& arm) {
  const std::string_view address = arm.device;
  if (!bus::is_simulated(address)) {
    return fail(Errc::InvalidArgument, arm.device + " is no simulated device (sim:MODEL)");
  }
  const plugin::SimModelEntry* entry = models.find(bus::simulated_model(address));
  if (entry == nullptr) {
    std::string known;
    for (const plugin::SimModelEntry& model : models.entries()) known += " sim:" + model.name;
    return fail(Errc::NotFound, "no simulated device " + arm.device + "; there are:" + known);
  }
  plugin::SimModelSettings settings;
  settings.amplifier_max_a = arm.amplifier_max_a.value_or(0);
  settings.seed = arm.hand ? arm.hand->seed : 0;
  Result<plugin::SimModel> model = entry->create(settings);
  if (!model) return tl::unexpected(model.error().in(arm.device));

  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<SimArm> sim_arm(new SimArm());
  sim_arm->backend_ = plugin::arm_backend(*model);
  if (sim_arm->backend_ == nullptr) {
    return fail(Errc::InvalidArgument, arm.device + " is no arm");
  }
  const Result<void> plugged = sim_arm->buses_.plug_any({arm.device}, *std::move(model));
  if (!plugged) return tl::unexpected(plugged.error());
  if (arm.hand) {
    const Result<void> sound = sim::check(hand_settings(*arm.hand));
    if (!sound) return tl::unexpected(sound.error().in("hand"));
    sim_arm->person_ = std::make_unique<sim::Person>(*sim_arm->backend_, hand_settings(*arm.hand));
  }
  return sim_arm;
}

void SimArm::ask_person_to_calibrate() noexcept {
  if (person_) person_->ask_to_calibrate();
}

}  // namespace thimble::session
