#pragma once

#include <functional>
#include <vector>

#include "daemon/world/fields/distance_field.hpp"

namespace thimble::world::testing {

// A field of `distance_m`, taken at the nodes of a cube of so many a side.
inline DistanceField sampled(std::uint32_t nodes, double step_m,
                             const std::function<double(Position3)>& distance_m) {
  std::vector<float> metres;
  const double middle = (nodes - 1) / 2.0;
  for (std::uint32_t z = 0; z < nodes; ++z) {
    for (std::uint32_t y = 0; y < nodes; ++y) {
      for (std::uint32_t x = 0; x < nodes; ++x) {
        metres.push_back(static_cast<float>(
            distance_m({(x - middle) * step_m, (y - middle) * step_m, (z - middle) * step_m})));
      }
    }
  }
  return DistanceField::create({nodes, nodes, nodes}, step_m, std::move(metres)).value();
}

}  // namespace thimble::world::testing
