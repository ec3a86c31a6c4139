#include "lab/stability/stability_cases.hpp"

#include <algorithm>

#include "daemon/coupling/slave.hpp"
#include "lab/stability/theory.hpp"

namespace thimble::lab {
namespace {

using coupling::Scheme;

constexpr double kServoPeriod_s = 1e-3;
constexpr double kHardestWall_newton_per_m = coupling::kHardestTool.stiffness.newton_per_m;
constexpr double kHardestSpring_newton_per_m = coupling::kHardestController.stiffness.newton_per_m;
// Walls that are rendered here have no ceiling of the far end's.
constexpr double kNoCeiling_newton_per_m = 1e6;
constexpr double kAsPhantom_newton_s_per_m = 2;
constexpr double kSpringDamper_newton_s_per_m =
    coupling::SpringDamperSettings{}.tool.damping.newton_s_per_m;
constexpr double kHysteresis_m = coupling::GhostPointSettings{}.hysteresis_m;
// Ours: how far around the theory is looked.
constexpr double kBelow = 0.4;
constexpr double kAbove = 10;

StabilityCase remote_force(double damping_newton_s_per_m) {
  return {.name = "remote-force",
          .theory = Theory::RemoteForce,
          .damping_newton_s_per_m = damping_newton_s_per_m,
          .ceiling_newton_per_m = kHardestWall_newton_per_m,
          .with = [](double newton_per_m) {
            Release how{.of = {.name = "remote-force", .scheme = Scheme::RemoteForce}};
            how.of.settings.remote_force.tool.stiffness = {newton_per_m};
            how.depth_m = how.push_newton / newton_per_m;
            return how;
          }};
}

StabilityCase spring_damper(coupling::ForceAt at) {
  const bool is_both = at == coupling::ForceAt::Both;
  return {.name = is_both ? "spring-damper, both ends" : "spring-damper",
          .theory = is_both ? Theory::BothEnds : Theory::WorldEnd,
          .damping_newton_s_per_m = 0,  // so that nothing but the scheme's own B holds it
          .ceiling_newton_per_m = kHardestSpring_newton_per_m,
          .with =
              [at](double newton_per_m) {
                Release how{.of = {.name = "spring-damper", .scheme = Scheme::SpringDamper}};
                how.of.settings.spring_damper.tool.stiffness = {newton_per_m};
                how.of.settings.spring_damper.softens_with_delay = false;
                how.of.settings.spring_damper.force_at = at;
                how.of.world_half.force_at = at;
                return how;
              },
          .has_slave = true};
}

StabilityCase wave(const char* name, double impedance_newton_s_per_m) {
  return {.name = name,
          .theory = Theory::Passive,
          .damping_newton_s_per_m = kAsPhantom_newton_s_per_m,
          .ceiling_newton_per_m = kHardestWall_newton_per_m,
          .with = [impedance_newton_s_per_m](double newton_per_m) {
            Release how{.of = {.name = "wave", .scheme = Scheme::Wave},
                        .wall_newton_per_m = newton_per_m};
            how.of.settings.wave.impedance = {impedance_newton_s_per_m};
            return how;
          }};
}

// Without damping and springs of its own: only what the formula knows.
StabilityCase here(const char* name, Scheme scheme, link::SendMode mode) {
  return {.name = name,
          .theory = Theory::DeviceLimited,
          .damping_newton_s_per_m = kAsPhantom_newton_s_per_m,
          .ceiling_newton_per_m = kNoCeiling_newton_per_m,
          .with = [scheme, mode](double newton_per_m) {
            Release how{.of = {.name = "local", .scheme = scheme, .mode = mode},
                        .push_newton = kLean_newton,
                        .depth_m = kHysteresis_m};
            coupling::SchemeSettings& settings = how.of.settings;
            settings.ghost_point.stiffness = {newton_per_m};
            settings.ghost_point.damping = {0};
            settings.ghost_point.coordinate_spring = {0};
            settings.constraint_plane.stiffness = {newton_per_m};
            settings.constraint_plane.damping = {0};
            settings.buffer_zone.tool = {.stiffness = {newton_per_m}, .damping = {0}};
            return how;
          }};
}

StabilityCase ghost_point_as_it_ships() {
  StabilityCase of = here("ghost-point, as it ships", Scheme::GhostPoint, link::SendMode::Streamed);
  of.theory = Theory::NoDelay;
  of.with = [](double newton_per_m) {
    Release how{.of = {.name = "ghost-point", .scheme = Scheme::GhostPoint},
                .push_newton = kLean_newton,
                .depth_m = kHysteresis_m};
    how.of.settings.ghost_point.stiffness = {newton_per_m};
    return how;
  };
  return of;
}

Release released(const StabilityCase& of, double newton_per_m, double delay_s) {
  Release how = of.with(newton_per_m);
  how.delay_s = delay_s;
  how.mass_kg = kHand_kg;
  how.damping_newton_s_per_m = of.damping_newton_s_per_m;
  return how;
}

}  // namespace

double StabilityCase::theory_newton_per_m(double delay_s) const {
  switch (theory) {
    case Theory::RemoteForce:
      return short_delay_limit_newton_per_m(damping_newton_s_per_m, delay_s, kServoPeriod_s);
    case Theory::WorldEnd:
      return world_end_limit_newton_per_m(kSpringDamper_newton_s_per_m, delay_s, kServoPeriod_s);
    case Theory::BothEnds:
      return both_ends_limit_newton_per_m(kSpringDamper_newton_s_per_m, delay_s, kServoPeriod_s);
    case Theory::Passive:
      return ceiling_newton_per_m;
    case Theory::DeviceLimited:
    case Theory::NoDelay:
      break;
  }
  return short_delay_limit_newton_per_m(damping_newton_s_per_m, 0, kServoPeriod_s);
}

Result<bool> StabilityCase::is_stable(double newton_per_m, double delay_s) const {
  Release how = released(*this, newton_per_m, delay_s);
  const auto leaning = let_go(how);
  if (!leaning) return tl::unexpected(leaning.error());
  if (!has_slave || !leaning->is_stable) return leaning->is_stable;
  how.push_newton = 0;
  how.depth_m = -kClear_m;
  return let_go(how).map([](const Released& floating) { return floating.is_stable; });
}

Result<Largest> StabilityCase::find_largest(double delay_s) const {
  const double expected = theory_newton_per_m(delay_s);
  const SearchRange range{.low_newton_per_m = std::min(expected, ceiling_newton_per_m) * kBelow,
                          .high_newton_per_m = std::min(expected * kAbove, ceiling_newton_per_m)};
  return largest_stable(range, [&](double k) { return is_stable(k, delay_s); });
}

std::vector<StabilityCase> stability_cases() {
  using link::SendMode;
  return {remote_force(2),
          remote_force(4),
          remote_force(8),
          spring_damper(coupling::ForceAt::World),
          spring_damper(coupling::ForceAt::Both),
          wave("wave, b = 2", 2),
          wave("wave, b = 10", 10),
          wave("wave, b = 40", 40),
          here("ghost-point", Scheme::GhostPoint, SendMode::Streamed),
          here("ghost-point, lock-step", Scheme::GhostPoint, SendMode::LockStep),
          here("constraint-plane", Scheme::ConstraintPlane, SendMode::Streamed),
          here("buffer-zone", Scheme::BufferZone, SendMode::Streamed),
          here("composite", Scheme::Composite, SendMode::Streamed),
          ghost_point_as_it_ships()};
}

}  // namespace thimble::lab
