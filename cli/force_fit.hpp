#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::cli {

// What a scale under the tip said while a force pressed on it.
struct ScaleReading {
  double pressed_newton{0};  // downwards, as the limiter let it through
  double shown_gram{0};      // as the scale shows it
};

// What those say of an arm that is told counts.
struct ForceScale {
  double newton_per_count{0};
  double rest_gram{0};         // what the arm weighs on the scale with no force
  double worst_off_newton{0};  // of a reading from the straight line
};

// Ours: below it, two readings that are off by a gram each, the one up and the other down, make a
// slope that is off by more than 5 %, and one too low makes every force stronger. 400 counts of the
// weakest arm that a configuration takes (0.001 N a count) are 41 g.
inline constexpr double kLeastSpan_gram = 40;

// By how much the scale showed more at the strongest force than at the weakest, in grams: above 0
// where the arm presses down. 0 without a reading. Pure; total.
[[nodiscard]] double rise_gram(const std::vector<ScaleReading>& readings);

// The forces to ask for: from 0 up to `most_newton`, in even steps, each once.
[[nodiscard]] std::vector<double> even_forces_newton(double most_newton, std::size_t count);

// A straight line through the readings: its slope is by how much `assumed_newton_per_count` is off.
// What the arm weighs, and the tare of the scale, fall out. Pure; total.
// Errors: InvalidArgument, for a person: fewer than three forces, a slope that no Falcon has
// (a twentieth to five times what was assumed), readings that lie on no line, or a line of fewer
// than kLeastSpan_gram from end to end.
[[nodiscard]] Result<ForceScale> fit_force(const std::vector<ScaleReading>& readings,
                                           double assumed_newton_per_count);

// Grams as a person types them: "123", "123.5", "123,5", "123 g". Nothing else, and nothing beyond
// ±20 kg.
[[nodiscard]] Result<double> parse_gram(const std::string& typed);

}  // namespace thimble::cli
