#include "daemon/session/arm_settings.hpp"

#include <algorithm>
#include <limits>

#include "daemon/config/endpoint.hpp"
#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/two_port_arm.hpp"
#include "daemon/session/arm_rig.hpp"

namespace thimble::session {

plugin::DriverSettings driver_settings(const config::ArmConfig& arm) {
  plugin::DriverSettings settings;
  settings.model = arm.model.value_or("");
  settings.amplifier_max_a = arm.amplifier_max_a;
  settings.firmware = arm.firmware.value_or("");
  settings.firmware_sha256 = arm.firmware_sha256.value_or("");
  settings.newton_per_count = arm.newton_per_count;
  // The configuration gives a full address, by serial number or port: it names this device.
  settings.is_named_by_person = true;
  return settings;
}

Result<servo::ServoSettings> servo_settings(const config::ArmConfig& arm,
                                            const config::ServoConfig& servo,
                                            const HapticCapabilities& capabilities) {
  servo::LimitRequest request;
  request.force_newton = arm.limits.force_newton.value_or(0);
  request.rise_newton_per_s = arm.limits.rise_newton_per_s;
  const Result<servo::LimiterSettings> limiter =
      servo::make_limiter_settings(capabilities, request);
  if (!limiter) return tl::unexpected(limiter.error());

  servo::ServoSettings settings;
  settings.rate_hz = servo.rate_hz.value_or(capabilities.full_rate_hz);
  settings.limiter = *limiter;
  if (capabilities.sample_period > Duration::zero()) {
    settings.freshness.exchange_period = capabilities.sample_period;
  }
  // An arm that answers what it hears does so no more often than it is asked (decision 0081).
  settings.freshness.exchange_period =
      std::max(settings.freshness.exchange_period, settings.period());
  settings.overspeed_m_per_s = arm.limits.overspeed_m_per_s;
  settings.activation_ramp = from_seconds(arm.limits.ramp_s);
  settings.is_realtime_required = servo.realtime == config::Realtime::Required;
  return settings;
}

namespace {

coupling::GhostPointSettings ghost_point_settings(const config::CouplingConfig& said, double cell_m,
                                                  double most_newton_per_m) {
  coupling::GhostPointSettings settings;
  settings.cell_m = cell_m;
  settings.stiffness.newton_per_m = std::min(settings.stiffness.newton_per_m, most_newton_per_m);
  settings.max_stiffness.newton_per_m =
      std::min(settings.max_stiffness.newton_per_m, most_newton_per_m);
  settings.stiffness.newton_per_m =
      said.stiffness_newton_per_m.value_or(settings.stiffness.newton_per_m);
  settings.damping.newton_s_per_m =
      said.damping_newton_s_per_m.value_or(settings.damping.newton_s_per_m);
  settings.coordinate_spring.newton_per_m =
      said.coordinate_spring_newton_per_m.value_or(settings.coordinate_spring.newton_per_m);
  settings.hysteresis_m = said.hysteresis_m.value_or(settings.hysteresis_m);
  settings.relaxation_m_per_s = said.relaxation_m_per_s.value_or(settings.relaxation_m_per_s);
  return settings;
}

// What the two schemes have in common is the ghost point's.
coupling::ConstraintPlaneSettings constraint_plane_settings(
    const config::CouplingConfig& said, const coupling::GhostPointSettings& ghost) {
  coupling::ConstraintPlaneSettings settings;
  settings.cell_m = ghost.cell_m;
  settings.stiffness = ghost.stiffness;
  settings.max_stiffness = ghost.max_stiffness;
  settings.damping = ghost.damping;
  settings.hysteresis_m = ghost.hysteresis_m;
  settings.relaxation_m_per_s = ghost.relaxation_m_per_s;
  settings.age = ghost.age;
  if (said.late_walls == config::CouplingLateWalls::Recovery) {
    settings.late_walls = coupling::LateWalls::Recovery;
  }
  if (said.recovery_s) settings.recovery_time = from_seconds(*said.recovery_s);
  return settings;
}

coupling::ToolProperties tool_of(const config::CouplingConfig& said,
                                 const coupling::ToolProperties& usual, double most_newton_per_m) {
  const double softer = std::min(usual.stiffness.newton_per_m, most_newton_per_m);
  return {.stiffness = {said.stiffness_newton_per_m.value_or(softer)},
          .damping = {said.damping_newton_s_per_m.value_or(usual.damping.newton_s_per_m)}};
}

coupling::ForceAt force_at(const config::CouplingConfig& said) {
  return said.force_at == config::CouplingForceAt::Both ? coupling::ForceAt::Both
                                                        : coupling::ForceAt::World;
}

coupling::ConstraintAgeSettings age_of(const config::CouplingConfig& said) {
  coupling::ConstraintAgeSettings age;
  if (said.freeze_after_s) age.freeze_floor = from_seconds(*said.freeze_after_s);
  if (said.fade_after_s) age.fade_floor = from_seconds(*said.fade_after_s);
  return age;
}

coupling::PassivitySettings passivity_settings(const config::PassivityConfig& said) {
  coupling::PassivitySettings settings;
  settings.bound_joule = said.bound_joule.value_or(settings.bound_joule);
  settings.most = {said.damping_newton_s_per_m.value_or(settings.most.newton_s_per_m)};
  settings.least_m_per_s = said.least_m_per_s.value_or(settings.least_m_per_s);
  return settings;
}

}  // namespace

coupling::Scheme scheme_of(config::CouplingScheme said) {
  switch (said) {
    case config::CouplingScheme::ThesisLiteral:
      return coupling::Scheme::ThesisLiteral;
    case config::CouplingScheme::RemoteForce:
      return coupling::Scheme::RemoteForce;
    case config::CouplingScheme::SpringDamper:
      return coupling::Scheme::SpringDamper;
    case config::CouplingScheme::Wave:
      return coupling::Scheme::Wave;
    case config::CouplingScheme::ConstraintPlane:
      return coupling::Scheme::ConstraintPlane;
    case config::CouplingScheme::BufferZone:
      return coupling::Scheme::BufferZone;
    case config::CouplingScheme::Composite:
      return coupling::Scheme::Composite;
    case config::CouplingScheme::Auto:  // of a world that is not known yet
    case config::CouplingScheme::GhostPoint:
      break;
  }
  return coupling::Scheme::GhostPoint;
}

namespace {

config::CouplingScheme word_of(coupling::Scheme scheme) {
  switch (scheme) {
    case coupling::Scheme::ThesisLiteral:
      return config::CouplingScheme::ThesisLiteral;
    case coupling::Scheme::RemoteForce:
      return config::CouplingScheme::RemoteForce;
    case coupling::Scheme::SpringDamper:
      return config::CouplingScheme::SpringDamper;
    case coupling::Scheme::Wave:
      return config::CouplingScheme::Wave;
    case coupling::Scheme::ConstraintPlane:
      return config::CouplingScheme::ConstraintPlane;
    case coupling::Scheme::BufferZone:
      return config::CouplingScheme::BufferZone;
    case coupling::Scheme::Composite:
      return config::CouplingScheme::Composite;
    case coupling::Scheme::GhostPoint:
      break;
  }
  return config::CouplingScheme::GhostPoint;
}

}  // namespace

bool leaves_scheme_to_world(const config::ArmConfig& arm) {
  return arm.is_remote() && arm.protocol == config::LinkProtocol::Thimble &&
         arm.coupling.scheme == config::CouplingScheme::Auto &&
         arm.coupling.mode == config::CouplingMode::Streamed && arm.deadband_m == 0 &&
         arm.place_m == std::array<double, 3>{};
}

link::ThimbleHalf half_of(const config::CouplingConfig& said) {
  const coupling::WorldHalfSettings settings = world_half_settings(said);
  const bool is_at_both = settings.force_at == coupling::ForceAt::Both;
  const bool names_faces = settings.buffer_zone.names == coupling::ZoneNames::Faces;
  return {.scheme = link::ShortName::of(to_string(scheme_of(said.scheme))),
          .force_at = is_at_both ? std::uint8_t{1} : std::uint8_t{0},
          .zone_names = names_faces ? std::uint8_t{1} : std::uint8_t{0},
          .buffer_m = settings.buffer_zone.buffer_m};
}

Result<config::CouplingConfig> coupling_of(const link::ThimbleHalf& half) {
  const Result<coupling::Scheme> scheme = coupling::parse_scheme(half.scheme.view());
  if (!scheme) return tl::unexpected(scheme.error());
  config::CouplingConfig said;
  said.scheme = word_of(*scheme);
  if (half.force_at == 1) said.force_at = config::CouplingForceAt::Both;
  if (half.zone_names == 1) said.zone = config::CouplingZone::Faces;
  if (said.scheme == config::CouplingScheme::BufferZone) said.buffer_m = half.buffer_m;
  return said;
}

coupling::WorldHalfSettings world_half_settings(const config::CouplingConfig& said) {
  coupling::WorldHalfSettings settings;
  settings.force_at = force_at(said);
  settings.buffer_zone.buffer_m = said.buffer_m.value_or(settings.buffer_zone.buffer_m);
  if (said.zone == config::CouplingZone::Faces) {
    settings.buffer_zone.names = coupling::ZoneNames::Faces;
  }
  return settings;
}

Result<std::unique_ptr<coupling::ArmCoupling>> make_coupling(
    const config::ArmConfig& arm, double cell_m, const HapticCapabilities& capabilities) {
  const config::CouplingConfig& said = arm.coupling;
  // What a person configures stands; it is limited as any wish is.
  const double most = capabilities.max_stiffness_newton_per_m > 0
                          ? capabilities.max_stiffness_newton_per_m
                          : std::numeric_limits<double>::max();
  coupling::SchemeSettings settings;
  settings.ghost_point = ghost_point_settings(said, cell_m, most);
  settings.remote_force.tool = tool_of(said, settings.remote_force.tool, most);
  settings.spring_damper.tool = tool_of(said, settings.spring_damper.tool, most);
  settings.spring_damper.force_at = arm.peer ? coupling::ForceAt::Both : force_at(said);
  settings.spring_damper.is_between_arms = arm.peer.has_value();
  settings.spring_damper.master_mass_kg = said.master_mass_kg.value_or(0);
  settings.buffer_zone.tool = tool_of(said, settings.buffer_zone.tool, most);
  settings.wave.impedance.newton_s_per_m =
      said.impedance_newton_s_per_m.value_or(settings.wave.impedance.newton_s_per_m);
  const coupling::ConstraintAgeSettings age = age_of(said);
  settings.ghost_point.age = age;
  settings.constraint_plane = constraint_plane_settings(said, settings.ghost_point);
  settings.remote_force.age = age;
  settings.spring_damper.age = age;
  settings.wave.age = age;
  settings.buffer_zone.age = age;
  std::unique_ptr<coupling::ArmCoupling> scheme = coupling::make_arm_coupling(
      leaves_scheme_to_world(arm) ? coupling::Scheme::Composite : scheme_of(said.scheme), settings);
  if (!said.passivity) return scheme;
  if (said.passivity->is_two_port) {
    return std::make_unique<coupling::TwoPortArm>(std::move(scheme),
                                                  passivity_settings(*said.passivity));
  }
  return std::make_unique<coupling::PassivityGuard>(std::move(scheme),
                                                    passivity_settings(*said.passivity));
}

Result<link::Endpoint> endpoint(const config::UdpEndpoint& said) {
  return link::parse_endpoint(config::to_string(said));
}

link::SendMode send_mode(const config::ArmConfig& arm) {
  return arm.coupling.mode == config::CouplingMode::LockStep ? link::SendMode::LockStep
                                                             : link::SendMode::Streamed;
}

link::SerialLine serial_line(const config::SerialEndpoint& said) {
  return {.name = to_string(said), .node = said.node, .bit_per_s = said.bit_per_s};
}

Result<link::ArmEndSettings> arm_end_settings(const config::ArmConfig& arm) {
  link::ArmEndSettings settings;
  settings.mode = send_mode(arm);
  settings.impairment = impairment_settings(arm.impairment);
  if (arm.protocol == config::LinkProtocol::Thimble) {
    settings.protocol = link::ArmEndSettings::Protocol::Thimble;
    settings.half = half_of(arm.coupling);
    if (leaves_scheme_to_world(arm)) {
      settings.else_half = settings.half;
      settings.half.scheme = link::ShortName::of(to_string(coupling::Scheme::Composite));
    }
    settings.deadband_m = arm.deadband_m;
  }
  if (!arm.key_file) return settings;
  const Result<link::LinkKey> key = link::load_key(*arm.key_file);
  if (!key) return tl::unexpected(key.error());
  settings.key = *key;
  return settings;
}

link::ImpairmentSettings impairment_settings(
    const std::optional<config::ImpairmentConfig>& impairment) {
  if (!impairment) return {};
  return {.delay_s = impairment->delay_s,
          .jitter_s = impairment->jitter_s,
          .loss = impairment->loss,
          .duplicate = impairment->duplicate,
          .reorder = impairment->reorder,
          .seed = impairment->seed};
}

}  // namespace thimble::session
