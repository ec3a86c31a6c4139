#pragma once

#include <cstddef>
#include <vector>

#include "lab/constraint_models/models.hpp"

namespace thimble::lab {

// What came of a model on a hand's way. The conditions are those of a god-object (teleop.md 2(f)):
// with normals n_i into the matter and n_i·x <= d_i free, g = q − Σ λ_i·n_i, λ_i >= 0, λ_i > 0 only
// where n_i·g = d_i.
struct Verdict {
  std::size_t steps{0};
  std::size_t outside{0};    // steps with a plane that the proxy is past: not in the admissible set
  std::size_t pulling{0};    // with λ < 0
  std::size_t untouched{0};  // with λ > 0 on a plane that the proxy does not touch
  std::size_t in_matter{0};  // with the ghost deeper in matter than the model may have it
  double deepest_m{0};       // of the ghost in matter
  double apart_m{0};         // the most between proxy and ghost
  std::size_t most_planes{0};

  [[nodiscard]] bool is_admissible() const noexcept { return outside == 0; }
  [[nodiscard]] bool is_complementary() const noexcept { return pulling + untouched == 0; }
};

// Judges one step more.
void judge(const Model& model, const std::vector<world::PlacedShape>& matter, const HeldHand& held,
           Verdict& verdict);

}  // namespace thimble::lab
