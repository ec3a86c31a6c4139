#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "hal/base/units.hpp"

namespace thimble {

// Three Cartesian components of one physical quantity, SI. The frame is in the variable's
// name (p_base_tip) or in the comment of the struct that holds it. A quantity converts to
// another only along physics: stiffness × displacement is a force, a position is not.
template <class Quantity>
struct Vector3 {
  double x{}, y{}, z{};

  constexpr double operator[](std::size_t axis) const noexcept {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr double& operator[](std::size_t axis) noexcept {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr bool operator==(const Vector3&) const = default;

  friend constexpr Vector3 operator+(Vector3 a, Vector3 b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Vector3 operator-(Vector3 a, Vector3 b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vector3 operator-(Vector3 a) noexcept { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vector3 operator*(double s, Vector3 a) noexcept {
    return {s * a.x, s * a.y, s * a.z};
  }
  friend constexpr Vector3 operator*(Vector3 a, double s) noexcept { return s * a; }
  constexpr Vector3& operator+=(Vector3 b) noexcept { return *this = *this + b; }
  constexpr Vector3& operator-=(Vector3 b) noexcept { return *this = *this - b; }
};

using Direction3 = Vector3<struct DirectionTag>;        // unit length, dimensionless
using Displacement3 = Vector3<struct DisplacementTag>;  // m
using Velocity3 = Vector3<struct VelocityTag>;          // m/s
using Force3 = Vector3<struct ForceTag>;                // N

// A point, m. Points do not add.
struct Position3 {
  double x{}, y{}, z{};

  constexpr double operator[](std::size_t axis) const noexcept {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr double& operator[](std::size_t axis) noexcept {
    return axis == 0 ? x : axis == 1 ? y : z;
  }
  constexpr bool operator==(const Position3&) const = default;
  friend constexpr Displacement3 operator-(Position3 a, Position3 b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Position3 operator+(Position3 p, Displacement3 d) noexcept {
    return {p.x + d.x, p.y + d.y, p.z + d.z};
  }
  friend constexpr Position3 operator-(Position3 p, Displacement3 d) noexcept {
    return {p.x - d.x, p.y - d.y, p.z - d.z};
  }
};

constexpr Force3 operator*(Stiffness k, Displacement3 d) noexcept {
  return {k.newton_per_m * d.x, k.newton_per_m * d.y, k.newton_per_m * d.z};
}
constexpr Force3 operator*(Damping b, Velocity3 v) noexcept {
  return {b.newton_s_per_m * v.x, b.newton_s_per_m * v.y, b.newton_s_per_m * v.z};
}

template <class A, class B>
[[nodiscard]] constexpr double dot(Vector3<A> a, Vector3<B> b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
// Signed distance of `p` along `n` from the origin of its frame, m.
[[nodiscard]] constexpr double dot(Direction3 n, Position3 p) noexcept {
  return n.x * p.x + n.y * p.y + n.z * p.z;
}
template <class Quantity>
[[nodiscard]] constexpr Vector3<Quantity> along(Direction3 n, double magnitude) noexcept {
  return {n.x * magnitude, n.y * magnitude, n.z * magnitude};
}
// The norm of what has squares out of a double's comfortable range: slow, and right.
[[nodiscard]] double norm_of_extremes(double x, double y, double z) noexcept;
// Euclidean norm, in the unit of the argument; overflow-free for finite input.
[[nodiscard]] inline double norm(double x, double y, double z) noexcept {
  constexpr double kSmallest = 1e-280;  // a square lost to underflow beside it does not show
  constexpr double kLargest = 1e300;
  const double squared = x * x + y * y + z * z;
  if (squared > kSmallest && squared < kLargest) return std::sqrt(squared);
  return norm_of_extremes(x, y, z);
}
template <class Quantity>
[[nodiscard]] double norm(Vector3<Quantity> v) noexcept {
  return norm(v.x, v.y, v.z);
}
[[nodiscard]] inline bool is_finite(double x, double y, double z) noexcept {
  return std::isfinite(x) && std::isfinite(y) && std::isfinite(z);
}
template <class Quantity>
[[nodiscard]] bool is_finite(Vector3<Quantity> v) noexcept {
  return is_finite(v.x, v.y, v.z);
}
[[nodiscard]] inline bool is_finite(Position3 p) noexcept { return is_finite(p.x, p.y, p.z); }

// Row-major 3×3; the unit is that of the member holding it.
struct Matrix3 {
  std::array<std::array<double, 3>, 3> row{};
  constexpr bool operator==(const Matrix3&) const = default;
};

}  // namespace thimble
