#include "lab/compare/compared.hpp"

namespace thimble::lab {
namespace {

CouplingCase wave_of(const char* name, double newton_s_per_m) {
  CouplingCase wave{.name = name, .scheme = coupling::Scheme::Wave};
  wave.settings.wave.impedance.newton_s_per_m = newton_s_per_m;
  return wave;
}

}  // namespace

std::vector<CouplingCase> compared_schemes() {
  using coupling::Scheme;
  return {
      {.name = "remote-force", .scheme = Scheme::RemoteForce},
      {.name = "spring-damper", .scheme = Scheme::SpringDamper},
      {.name = "spring-damper, both",
       .scheme = Scheme::SpringDamper,
       .settings = {.spring_damper = {.force_at = coupling::ForceAt::Both}},
       .world_half = {.force_at = coupling::ForceAt::Both}},
      wave_of("wave, b = 2", 2),
      wave_of("wave, b = 10", 10),
      wave_of("wave, b = 40", 40),
      {.name = "ghost-point", .scheme = Scheme::GhostPoint},
      {.name = "ghost-point, lock-step",
       .scheme = Scheme::GhostPoint,
       .mode = link::SendMode::LockStep},
      {.name = "constraint-plane", .scheme = Scheme::ConstraintPlane},
      {.name = "buffer-zone", .scheme = Scheme::BufferZone},
      {.name = "composite", .scheme = Scheme::Composite},
  };
}

std::vector<CouplingCase> schemes_beside() {
  using coupling::Scheme;
  CouplingCase recovery{.name = "constraint-plane, recovery", .scheme = Scheme::ConstraintPlane};
  recovery.settings.constraint_plane.late_walls = coupling::LateWalls::Recovery;
  CouplingCase faces{.name = "buffer-zone, faces", .scheme = Scheme::BufferZone};
  faces.world_half.buffer_zone.names = coupling::ZoneNames::Faces;
  return {recovery,
          faces,
          {.name = "thesis-literal",
           .scheme = Scheme::ThesisLiteral,
           .mode = link::SendMode::LockStep}};
}

CouplingCase reference_scheme() { return {.name = "ghost-point, undelayed"}; }

}  // namespace thimble::lab
