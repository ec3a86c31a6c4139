#pragma once

#include "lab/findings/findings.hpp"

namespace thimble::lab {

// Marks in a plot over the delay, ms, what the thesis says of the comfort of its hand, from 0 up to
// `most` in the units of the plot's y.
// SOURCE: thesis 4.1, as in teleop.md section 1, "comfort statements".
inline void add_comfort_marks(Plot& plot, double most) {
  plot.series.push_back(
      {"thesis: 50 ms, as if there were none", Mark::Dashed, {{50, 0}, {50, most}}, 7});
  plot.series.push_back({"thesis: 200 ms, upper end", Mark::Dashed, {{200, 0}, {200, most}}, 8});
}

}  // namespace thimble::lab
