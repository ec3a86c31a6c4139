#include "daemon/coupling/scheme.hpp"

#include <string>

#include "daemon/coupling/remote_force_world.hpp"
#include "daemon/coupling/spring_damper_world.hpp"
#include "daemon/coupling/thesis_literal.hpp"
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
  }
  return "unknown";
}

Result<Scheme> parse_scheme(std::string_view text) {
  for (const Scheme scheme : kSchemes) {
    if (to_string(scheme) == text) return scheme;
  }
  return fail(Errc::InvalidArgument, "unknown coupling scheme '" + std::string(text) +
                                         "'; expected ghost-point, thesis-literal, remote-force, "
                                         "spring-damper, wave or constraint-plane");
}

bool computes_at_the_far_end(Scheme scheme) noexcept {
  return scheme == Scheme::RemoteForce || scheme == Scheme::SpringDamper || scheme == Scheme::Wave;
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
    case Scheme::GhostPoint:
      break;
  }
  return std::make_unique<GhostPointArm>(settings.ghost_point);
}

Result<std::unique_ptr<WorldCoupling>> make_far_end(Scheme scheme, ForceAt force_at,
                                                    world::World& world,
                                                    std::uint32_t first_session) {
  if (scheme == Scheme::RemoteForce) {
    return std::make_unique<RemoteForceWorld>(world, first_session);
  }
  if (scheme == Scheme::SpringDamper) {
    return std::make_unique<SpringDamperWorld>(world, first_session, force_at);
  }
  if (scheme == Scheme::Wave) return std::make_unique<WaveWorld>(world, first_session);
  return fail(Errc::InvalidArgument,
              std::string(to_string(scheme)) + " does not compute at the far end");
}

}  // namespace thimble::coupling
