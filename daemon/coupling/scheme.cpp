#include "daemon/coupling/scheme.hpp"

#include <string>

#include "daemon/coupling/composite_world.hpp"
#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/spring_damper_world.hpp"
#include "daemon/coupling/thesis_literal.hpp"
#include "daemon/coupling/two_port_world.hpp"
#include "daemon/coupling/wave_world.hpp"

namespace thimble::coupling {

std::string_view to_string(Scheme scheme) noexcept {
  switch (scheme) {
    case Scheme::GhostPoint:
      return "ghost-point";
    case Scheme::ThesisLiteral:
      return "thesis-literal";
    case Scheme::RemoteForce:
      return "remote-force";
    case Scheme::SpringDamper:
      return "spring-damper";
    case Scheme::Wave:
      return "wave";
    case Scheme::ConstraintPlane:
      return "constraint-plane";
    case Scheme::BufferZone:
      return "buffer-zone";
    case Scheme::Composite:
      return "composite";
  }
  return "unknown";
}

Result<Scheme> parse_scheme(std::string_view text) {
  for (const Scheme scheme : kSchemes) {
    if (to_string(scheme) == text) return scheme;
  }
  return fail(Errc::InvalidArgument,
              "unknown coupling scheme '" + std::string(text) +
                  "'; expected ghost-point, thesis-literal, remote-force, "
                  "spring-damper, wave, constraint-plane, buffer-zone or composite");
}

bool has_own_world_half(Scheme scheme) noexcept {
  return scheme == Scheme::RemoteForce || scheme == Scheme::SpringDamper ||
         scheme == Scheme::Wave || scheme == Scheme::BufferZone || scheme == Scheme::Composite;
}

bool is_force_of_world(Scheme scheme, ForceAt force_at) noexcept {
  return scheme == Scheme::RemoteForce ||
         (scheme == Scheme::SpringDamper && force_at == ForceAt::World);
}

std::unique_ptr<ArmCoupling> make_arm_coupling(Scheme scheme, const SchemeSettings& settings) {
  switch (scheme) {
    case Scheme::ThesisLiteral:
      return std::make_unique<ThesisLiteralArm>(settings.ghost_point.age);
    case Scheme::RemoteForce:
      return std::make_unique<RemoteForceArm>(settings.remote_force);
    case Scheme::SpringDamper:
      return std::make_unique<SpringDamperArm>(settings.spring_damper);
    case Scheme::Wave:
      return std::make_unique<WaveArm>(settings.wave);
    case Scheme::ConstraintPlane:
      return std::make_unique<ConstraintPlaneArm>(settings.constraint_plane);
    case Scheme::BufferZone:
      return std::make_unique<BufferZoneArm>(settings.buffer_zone);
    case Scheme::Composite:
      return std::make_unique<CompositeArm>(settings.ghost_point);
    case Scheme::GhostPoint:
      break;
  }
  return std::make_unique<GhostPointArm>(settings.ghost_point);
}

Result<std::unique_ptr<WorldCoupling>> make_own_world_half(Scheme scheme,
                                                           const WorldHalfSettings& settings,
                                                           world::World& world,
                                                           std::uint32_t first_session) {
  switch (scheme) {
    case Scheme::RemoteForce:
      return std::make_unique<TwoPortWorld>(
          std::make_unique<RemoteForceWorld>(world, first_session));
    case Scheme::SpringDamper: {
      auto half = std::make_unique<SpringDamperWorld>(world, first_session, settings.force_at);
      if (!is_force_of_world(scheme, settings.force_at)) return half;
      return std::make_unique<TwoPortWorld>(std::move(half));
    }
    case Scheme::Wave:
      return std::make_unique<WaveWorld>(world, first_session);
    case Scheme::BufferZone:
      return std::make_unique<BufferZoneWorld>(world, first_session, settings.buffer_zone);
    case Scheme::Composite:
      return std::make_unique<CompositeWorld>(world, first_session);
    case Scheme::GhostPoint:
    case Scheme::ThesisLiteral:
    case Scheme::ConstraintPlane:
      break;
  }
  return fail(Errc::InvalidArgument,
              std::string(to_string(scheme)) + " has no world half of its own");
}

}  // namespace thimble::coupling
