#pragma once

#include <string>
#include <vector>

#include "tests/campaign/programme.hpp"

namespace thimble::campaign {

struct Material {
  double stiffness_newton_per_m{0};
  double damping_newton_s_per_m{0};
  double friction{0};
};
// Those of a volume, of the labels 1, 2 ... as many as there are.
[[nodiscard]] std::vector<Material> materials_of(const Setup& setup);

// The file of a volume, NRRD: a shell of random labels 1 to 3, within it one cell of four, and
// nothing about the middle, where the hand begins.
[[nodiscard]] std::string volume_of(const Setup& setup);

// What tests/data/hello.toml does not have: materials, and the other arm.
[[nodiscard]] std::string more_configuration(const Setup& setup);

}  // namespace thimble::campaign
