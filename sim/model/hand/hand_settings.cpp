#include "sim/model/hand/hand_settings.hpp"

#include <string>

namespace thimble::sim {

std::string_view to_string(HandMotion motion) noexcept {
  switch (motion) {
    case HandMotion::Still:
      return "still";
    case HandMotion::Poke:
      return "poke";
    case HandMotion::Sweep:
      return "sweep";
    case HandMotion::Circle:
      return "circle";
    case HandMotion::Tremor:
      return "tremor";
    case HandMotion::Explore:
      return "explore";
  }
  return "unknown";
}

std::optional<HandMotion> parse_hand_motion(std::string_view word) noexcept {
  for (const HandMotion motion : kHandMotions) {
    if (to_string(motion) == word) return motion;
  }
  return std::nullopt;
}

Result<void> check(const HandSettings& s) {
  if (s.axis > 2) return fail(Errc::InvalidArgument, "axis must be 0, 1 or 2");
  struct Bound {
    double value, low, high;
    const char* name;
  };
  const std::array bounds{Bound{s.reach_m, 0, 0.1, "reach_m"},
                          Bound{s.speed_m_per_s, 0.001, 0.5, "speed_m_per_s"},
                          Bound{s.mass_kg, 0.02, 5, "mass_kg"},
                          Bound{s.stiffness_newton_per_m, 0, 2e4, "stiffness_newton_per_m"},
                          Bound{s.damping_newton_s_per_m, 0, 100, "damping_newton_s_per_m"},
                          Bound{s.contact_newton_per_m, 1, 2e4, "contact_newton_per_m"},
                          Bound{s.contact_newton_s_per_m, 0, 100, "contact_newton_s_per_m"}};
  for (const Bound& b : bounds) {
    if (b.value >= b.low && b.value <= b.high) continue;
    return fail(Errc::InvalidArgument, std::string(b.name) + " must be " + std::to_string(b.low) +
                                           " to " + std::to_string(b.high));
  }
  return {};
}

}  // namespace thimble::sim
