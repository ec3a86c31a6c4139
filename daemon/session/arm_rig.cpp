#include "daemon/session/arm_rig.hpp"

#include <string_view>
#include <utility>

#include "daemon/devices/open_arm.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/combination.hpp"
#include "daemon/session/entry.hpp"
#include "daemon/session/world_host.hpp"

namespace thimble::session {
namespace {

bool must_fall_back(const config::ArmConfig& arm, const RigParts& parts) {
  return arm.fallback == config::Fallback::Simulated && parts.real_buses != nullptr &&
         !devices::find_device(*parts.real_buses, {arm.device});
}

// Errors: Unsupported, `parts` has no way there; the link's.
Result<std::unique_ptr<RigLink>> link_to_other_host(const config::ArmConfig& arm,
                                                    const RigParts& parts) {
  const Clock* const clock = network_clock(parts);
  if (arm.line) {
    if (parts.lines == nullptr || clock == nullptr) {
      return fail(Errc::Unsupported, "line: this program has no serial ports; name a world");
    }
    return make_serial_link(arm, *parts.lines, *clock, parts.wake);
  }
  if (parts.network == nullptr || clock == nullptr) {
    return fail(Errc::Unsupported, "link: there is no network to another host; name a world");
  }
  return make_udp_link(arm, *parts.network, *clock, parts.wake);
}

}  // namespace

Result<std::unique_ptr<ArmRig>> ArmRig::create_stand_in(const config::ArmConfig& arm,
                                                        const config::ServoConfig& servo,
                                                        WorldHost* world, const RigParts& parts) {
  const Result<config::ArmConfig> simulated = stand_in_for(arm, parts.models);
  if (!simulated) return tl::unexpected(simulated.error().in("arm '" + arm.name + "'"));
  Result<std::unique_ptr<ArmRig>> rig = create(*simulated, servo, world, parts);
  if (rig) (*rig)->await(arm, simulated->device, parts);
  return rig;
}

devices::DeviceExecutor& ArmRig::executor_of(const config::ArmConfig& arm, const RigParts& parts) {
  return parts.executor_for ? parts.executor_for(arm.name) : inline_executor_;
}

template <class Instead>
void ArmRig::await(const config::ArmConfig& arm, const Instead& instead, const RigParts& parts) {
  awaited_.emplace(OpenRequest{arm, parts.real_buses, &parts.drivers, parts.real_clock}, instead,
                   executor_of(arm, parts));
}

Result<void> ArmRig::choose_bus(const config::ArmConfig& arm, const RigParts& parts) {
  if (bus::is_simulated(arm.device)) {
    Result<std::unique_ptr<SimArm>> sim_arm = SimArm::create(parts.models, arm);
    if (!sim_arm) return tl::unexpected(sim_arm.error());
    sim_arm_ = *std::move(sim_arm);
    buses_ = &sim_arm_->buses();
    clock_ = &sim_arm_->clock();
    if (parts.wrap_sim_bus) {
      wrapped_buses_ = parts.wrap_sim_bus(*buses_, *clock_);
      buses_ = wrapped_buses_.get();
    }
    if (parts.real_clock != nullptr) {
      clock_ = &brake_.emplace(sim_arm_->clock(), *parts.real_clock);
    }
    return {};
  }
  if (parts.real_buses == nullptr || parts.real_clock == nullptr) {
    return fail(Errc::Unsupported, arm.device +
                                       " cannot be opened: this build knows simulated devices " +
                                       "only; use for instance sim:phantom-vintage");
  }
  buses_ = parts.real_buses;
  clock_ = parts.real_clock;
  executor_ = &executor_of(arm, parts);
  return {};
}

const Clock* network_clock(const RigParts& parts) noexcept {
  return parts.network_clock != nullptr ? parts.network_clock : parts.real_clock;
}

Result<void> ArmRig::link_to(WorldHost* world, const config::ArmConfig& arm,
                             const RigParts& parts) {
  if (arm.peer || arm.is_listening()) {
    auto half = parts.make_peer_half ? parts.make_peer_half(arm) : nullptr;
    const std::string peer = arm.peer.value_or(arm.name);
    if (!half) return fail(Errc::Unsupported, "peer: no arm '" + peer + "' is here");
    config::ArmConfig here = arm;
    if (arm.is_listening()) here.impairment.reset();  // of the way to the other host
    link_ = make_in_process_link(here, std::move(half), false, parts.wake);
    return {};
  }
  if (world != nullptr) {
    Result<void> good = check_combination(world->world(), arm.coupling);
    if (!good) return good;
    auto world_half = world->make_world_half(arm.coupling, parts.first_session);
    if (!world_half) return tl::unexpected(world_half.error());
    link_ =
        make_in_process_link(arm, *std::move(world_half), world->world().has_actions(), parts.wake);
    return {};
  }
  auto link = link_to_other_host(arm, parts);
  if (!link) return tl::unexpected(link.error());
  link_ = *std::move(link);
  return {};
}

Result<void> ArmRig::connect(const config::ArmConfig& arm, WorldHost* world,
                             const RigParts& parts) {
  if (Result<void> chosen = choose_bus(arm, parts); !chosen) return chosen;
  if (Result<void> linked = link_to(world, arm, parts); !linked) return linked;
  if (arm.place_m != std::array<double, 3>{}) {
    const auto& [x, y, z] = arm.place_m;
    placed_link_.emplace(link_->arm_end(), Displacement3{x, y, z});
  }
  if (parts.wrap_link) wrapped_link_ = parts.wrap_link(arm_end());
  return {};
}

ArmSessionParts ArmRig::session_parts(const config::ArmConfig& arm, WorldHost* world,
                                      const RigParts& parts) {
  return {*buses_,
          parts.drivers,
          wrapped_link_ ? *wrapped_link_ : arm_end(),
          *executor_,
          *clock_,
          parts.stopwatch != nullptr ? *parts.stopwatch : *clock_,
          world != nullptr ? world->world().info().cell_m : 0,
          parts.guards,
          world != nullptr ? entry_into(world->world(), arm.place_m) : servo::EntryBox{}};
}

template <class MakeSession>
Result<std::unique_ptr<ArmRig>> ArmRig::make(const config::ArmConfig& arm, WorldHost* world,
                                             const RigParts& parts,
                                             const MakeSession& make_session) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<ArmRig> rig(new ArmRig());
  const Result<void> connected = rig->connect(arm, world, parts);
  if (!connected) return tl::unexpected(connected.error().in("arm '" + arm.name + "'"));
  Result<std::unique_ptr<ArmSession>> session = make_session(rig->session_parts(arm, world, parts));
  if (!session) return tl::unexpected(session.error());
  rig->session_ = *std::move(session);
  return rig;
}

Result<std::unique_ptr<ArmRig>> ArmRig::create(const config::ArmConfig& arm,
                                               const config::ServoConfig& servo, WorldHost* world,
                                               const RigParts& parts) {
  if (must_fall_back(arm, parts)) return create_stand_in(arm, servo, world, parts);
  return make(arm, world, parts, [&](const ArmSessionParts& of_session) {
    return ArmSession::create(arm, servo, of_session);
  });
}

Result<std::unique_ptr<ArmRig>> ArmRig::create_found(const config::ArmConfig& arm,
                                                     const config::ServoConfig& servo,
                                                     WorldHost* world, const RigParts& parts,
                                                     Opened opened) {
  auto rig = make(arm, world, parts, [&](const ArmSessionParts& of_session) {
    return ArmSession::create(arm, servo, of_session, std::move(opened));
  });
  // Where it did not come to a session, the device is still here.
  if (!rig && parts.executor_for) {
    parts.executor_for(arm.name).close(std::move(opened.device));
  }
  return rig;
}

Result<std::unique_ptr<ArmRig>> ArmRig::create_lost(const config::ArmConfig& arm,
                                                    const config::ServoConfig& servo,
                                                    WorldHost* world, const RigParts& parts,
                                                    const Error& why) {
  auto rig = make(arm, world, parts, [&](const ArmSessionParts& of_session) {
    return ArmSession::create_lost(arm, servo, of_session);
  });
  if (rig) (*rig)->await(arm, why, parts);
  return rig;
}

std::string ArmRig::trouble() const {
  return awaited_ && !awaited_->has_stand_in() ? awaited_->sentence() : session_->trouble();
}

Result<void> ArmRig::follow(MonotonicTime now) {
  if (awaited_ && !awaited_->has_stand_in()) return {};  // its session has nothing to look after
  const bool needs_person = session_->snapshot().frame.calibration == CalibrationState::NeedsUser;
  if (sim_arm_ != nullptr && needs_person) sim_arm_->ask_person_to_calibrate();
  return session_->follow(now);
}

}  // namespace thimble::session
