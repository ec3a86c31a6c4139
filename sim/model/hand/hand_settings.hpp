#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::sim {

// What the simulated person means to do, about the origin of the arm's base frame.
enum class HandMotion : std::uint8_t {
  Still,    // rests at the origin
  Poke,     // presses out to `reach_m` along an axis, holds, comes back, again
  Sweep,    // to and fro between -45 and +45 mm along an axis at 0.2 m/s
  Circle,   // round the z axis at radius `reach_m`: presses on four walls in turn
  Tremor,   // drifts slowly and trembles at 8 to 12 Hz
  Explore,  // seeded visits to the six faces and eight corners of a box of half width `reach_m`
};
inline constexpr std::array kHandMotions{HandMotion::Still,  HandMotion::Poke,
                                         HandMotion::Sweep,  HandMotion::Circle,
                                         HandMotion::Tremor, HandMotion::Explore};
// Lower-case word, as in the configuration.
[[nodiscard]] std::string_view to_string(HandMotion motion) noexcept;
[[nodiscard]] std::optional<HandMotion> parse_hand_motion(std::string_view word) noexcept;

// A person's hand on the stylus. Mass, stiffness and damping: the dynamic hand of teleop.md
// section 4 (H2 and the model before it). Contact: ours, the soft tissue between thimble and
// bone, stiff and damped enough not to be felt beside the arm.
struct HandSettings {
  HandMotion motion{HandMotion::Explore};
  std::uint64_t seed{1};
  std::size_t axis{0};         // 0, 1, 2: x, y, z; of Poke and Sweep
  double reach_m{0.018};       // 3 mm into the walls of the thesis's box of +-15 mm
  double speed_m_per_s{0.15};  // of the reference, at most; not of Sweep
  double mass_kg{0.15};
  double stiffness_newton_per_m{200};
  double damping_newton_s_per_m{4};
  double contact_newton_per_m{5000};
  double contact_newton_s_per_m{20};
};

// InvalidArgument for a value that no hand has or that the model's step cannot follow: names
// the value and its limits.
[[nodiscard]] Result<void> check(const HandSettings& settings);

}  // namespace thimble::sim
