#include "daemon/session/arm_rig.hpp"

#include <string_view>
#include <utility>

#include "daemon/devices/arm_opener.hpp"
#include "daemon/session/combination.hpp"
#include "daemon/session/world_host.hpp"

namespace thimble::session {
namespace {

bool must_fall_back(const config::ArmConfig& arm, const RigParts& parts) {
  return arm.fallback == config::Fallback::Simulated && parts.real_buses != nullptr &&
         !devices::find_device(*parts.real_buses, {arm.device});
}

}  // namespace

Result<std::unique_ptr<ArmRig>> ArmRig::create_stand_in(const config::ArmConfig& arm,
                                                        const config::ServoConfig& servo,
                                                        WorldHost* world, const RigParts& parts) {
  const Result<config::ArmConfig> simulated = stand_in_for(arm, parts.models);
  if (!simulated) return tl::unexpected(simulated.error().in("arm '" + arm.name + "'"));
  Result<std::unique_ptr<ArmRig>> rig = create(*simulated, servo, world, parts);
  if (rig) (*rig)->awaited_.emplace(arm, simulated->device, *parts.real_buses);
  return rig;
}

Result<std::unique_ptr<ArmRig>> ArmRig::create(const config::ArmConfig& arm,
                                               const config::ServoConfig& servo, WorldHost* world,
                                               const RigParts& parts) {
  if (must_fall_back(arm, parts)) return create_stand_in(arm, servo, world, parts);
  const std::string name = "arm '" + arm.name + "'";
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<ArmRig> rig(new ArmRig());
  if (bus::is_simulated(arm.device)) {
    Result<std::unique_ptr<SimArm>> sim_arm = SimArm::create(parts.models, arm);
    if (!sim_arm) return tl::unexpected(sim_arm.error().in(name));
    rig->sim_arm_ = *std::move(sim_arm);
    rig->buses_ = &rig->sim_arm_->buses();
    rig->clock_ = &rig->sim_arm_->clock();
    if (parts.wrap_sim_bus) {
      rig->wrapped_buses_ = parts.wrap_sim_bus(*rig->buses_, *rig->clock_);
      rig->buses_ = rig->wrapped_buses_.get();
    }
    if (parts.real_clock != nullptr) {
      rig->clock_ = &rig->brake_.emplace(rig->sim_arm_->clock(), *parts.real_clock);
    }
  } else if (parts.real_buses == nullptr || parts.real_clock == nullptr) {
    return fail(Errc::Unsupported, name + ": " + arm.device +
                                       " cannot be opened: this build knows simulated devices " +
                                       "only; use for instance sim:phantom-vintage");
  } else {
    rig->buses_ = parts.real_buses;
    rig->clock_ = parts.real_clock;
  }

  if (world != nullptr) {
    const Result<void> good = check_combination(world->world(), arm.coupling);
    if (!good) return tl::unexpected(good.error().in(name));
    auto world_half = world->make_world_half(parts.first_session);
    if (!world_half) return tl::unexpected(world_half.error().in(name));
    rig->link_ = make_in_process_link(arm, *std::move(world_half), parts.wake);
  } else {
    if (parts.io == nullptr || parts.real_clock == nullptr) {
      return fail(Errc::Unsupported,
                  name + ": link: another host cannot be reached in virtual time; name a world");
    }
    Result<std::unique_ptr<RigLink>> link =
        make_udp_link(arm, *parts.io, *parts.real_clock, parts.wake);
    if (!link) return tl::unexpected(link.error().in(name));
    rig->link_ = *std::move(link);
  }

  if (parts.wrap_link) rig->wrapped_link_ = parts.wrap_link(rig->link_->arm_end());
  coupling::ArmLink& arm_end = rig->wrapped_link_ ? *rig->wrapped_link_ : rig->link_->arm_end();
  const Clock& stopwatch = parts.stopwatch != nullptr ? *parts.stopwatch : *rig->clock_;
  const ArmSessionParts session_parts{
      *rig->buses_, parts.drivers, arm_end,
      *rig->clock_, stopwatch,     world != nullptr ? world->world().info().cell_m : 0,
      parts.guards};
  Result<std::unique_ptr<ArmSession>> session = ArmSession::create(arm, servo, session_parts);
  if (!session) return tl::unexpected(session.error());
  rig->session_ = *std::move(session);
  return rig;
}

Result<void> ArmRig::follow(MonotonicTime now) {
  const bool needs_person = session_->snapshot().frame.calibration == CalibrationState::NeedsUser;
  if (sim_arm_ != nullptr && needs_person) sim_arm_->ask_person_to_calibrate();
  return session_->follow(now);
}

}  // namespace thimble::session
