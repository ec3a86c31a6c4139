#pragma once

#include <cstddef>
#include <cstdint>

#include "daemon/world/material_map.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

enum class ShapeKind : std::uint8_t {
  Sphere,    // radius
  Box,       // half its edges
  Capsule,   // radius, half the way between the centers of its ends, along y
  Cylinder,  // radius, half its height, along y
  Floor,     // everything below its center, y up
};

// A convex piece of matter. In a frame of its own, which is turned and then moved into the world's.
struct Shape {
  ShapeKind kind{ShapeKind::Sphere};
  Position3 center{};
  Displacement3 turn_rad{};  // rotation vector: about its direction, by its length
  double radius_m{0};
  Displacement3 half_m{};  // of a box all three; of capsule and cylinder y
  Material surface{};
};

// Ours: 32 distances are looked at in about a microsecond.
inline constexpr std::size_t kMaxShapes = 32;
// Smaller a shape is lost in the hysteresis.
inline constexpr double kLeastShape_m = 0.001;

// How far a place is outside, < 0 inside, and which way leads out fastest; unit length.
struct Outside {
  double distance_m{0};
  Direction3 outward{0, 1, 0};
};

// A shape and its matrix. Exact: distance_m is the distance to the nearest point of the surface,
// and outward its gradient (where several are as near, one of them). As those of any convex body,
// the distance is a convex function of the place: on a straight way it falls at most as fast as at
// the start, which is why a ghost may go distance/fall along it at once.
//
// Thread: any: pure. RT: look() THIMBLE_RT. Errors: none; finite in, finite out.
class PlacedShape {
 public:
  // `shape`: finite; what its kind has of sizes at least kLeastShape_m, else as large.
  explicit PlacedShape(const Shape& shape) noexcept;

  [[nodiscard]] THIMBLE_RT Outside look(Position3 at) const noexcept;
  [[nodiscard]] const Material& surface() const noexcept { return shape_.surface; }
  // Whether every number is finite and every size of its kind at least kLeastShape_m.
  [[nodiscard]] static bool is_sound(const Shape& shape) noexcept;

 private:
  Shape shape_;
  Matrix3 to_world_{};
};

}  // namespace thimble::world
