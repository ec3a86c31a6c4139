#include "lab/trial/declared_energy.hpp"

namespace thimble::lab {
namespace {

// Of a frame that is shifted.
struct Shifts {
  double wall_newton_per_m{0};
  double hysteresis_m{0};
  double spring_newton_per_m{0};
};

// thesis-literal's numbers are printed, and the ghost point's are as printed.
Shifts shifts_of(const CouplingCase& of) {
  const coupling::SchemeSettings as =
      of.scheme == coupling::Scheme::ThesisLiteral ? coupling::SchemeSettings{} : of.settings;
  if (of.scheme == coupling::Scheme::ConstraintPlane) {
    return {.wall_newton_per_m = as.constraint_plane.stiffness.newton_per_m,
            .hysteresis_m = as.constraint_plane.hysteresis_m};
  }
  return {.wall_newton_per_m = as.ghost_point.stiffness.newton_per_m,
          .hysteresis_m = as.ghost_point.hysteresis_m,
          .spring_newton_per_m = as.ghost_point.coordinate_spring.newton_per_m};
}

}  // namespace

double declared_joule(const CouplingCase& of, double contacts, double offset_m) noexcept {
  if (!(offset_m > 0)) return kPassive_joule;
  const Shifts shifts = shifts_of(of);
  return kPassive_joule +
         contacts * shifts.wall_newton_per_m * shifts.hysteresis_m * shifts.hysteresis_m / 2 +
         shifts.spring_newton_per_m * offset_m * offset_m / 2;
}

}  // namespace thimble::lab
