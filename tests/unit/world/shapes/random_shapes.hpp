#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "daemon/world/shapes/shape.hpp"

namespace thimble::world::testing {

// Shapes of every kind, turned any way, within 4 cm of the origin.
class RandomShapes {
 public:
  explicit RandomShapes(std::uint32_t seed) : random_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967295.0;
  }
  Position3 place(double reach_m) {
    return {uniform(-reach_m, reach_m), uniform(-reach_m, reach_m), uniform(-reach_m, reach_m)};
  }
  Shape shape(ShapeKind kind) {
    const Position3 turn = place(3);
    return {.kind = kind,
            .center = place(0.04),
            .turn_rad = {turn.x, turn.y, turn.z},
            .radius_m = uniform(0.001, 0.02),
            .half_m = {uniform(0.0005, 0.02), uniform(0.0005, 0.02), uniform(0.0005, 0.02)}};
  }
  // Without floors, which have no far side.
  Shape any() { return shape(static_cast<ShapeKind>(random_() % 4)); }
  std::vector<Shape> some(std::size_t count) {
    std::vector<Shape> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(any());
    return out;
  }

 private:
  std::mt19937 random_;
};

inline std::vector<PlacedShape> placed(const std::vector<Shape>& shapes) {
  return {shapes.begin(), shapes.end()};
}

// Of the union; what is nearest.
inline double distance_m(const std::vector<PlacedShape>& shapes, Position3 at) {
  double nearest_m = 1e9;
  for (const PlacedShape& shape : shapes)
    nearest_m = std::min(nearest_m, shape.look(at).distance_m);
  return nearest_m;
}

}  // namespace thimble::world::testing
