#include "daemon/world/shapes/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace thimble::world {
namespace {

// By the length of `turn` about its direction (Rodrigues' formula).
Matrix3 matrix_of(Displacement3 turn) noexcept {
  const double angle = norm(turn);
  if (!(angle > 0)) return {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  const double s = std::sin(angle);
  const double c = std::cos(angle);
  const Direction3 n{turn.x / angle, turn.y / angle, turn.z / angle};
  Matrix3 out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out.row[i][j] += (1 - c) * n[i] * n[j];
    out.row[i][i] += c;
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    out.row[j][k] -= s * n[i];
    out.row[k][j] += s * n[i];
  }
  return out;
}

double toward(double value) noexcept { return value < 0 ? -1 : 1; }

// From a point of the inside: the middle of a ball, the axis of a cylinder.
Outside from_core(Displacement3 away, double radius_m) noexcept {
  const double length_m = norm(away);
  if (!(length_m > 0)) return {-radius_m, {0, 1, 0}};
  return {length_m - radius_m, {away.x / length_m, away.y / length_m, away.z / length_m}};
}

Outside from_box(Displacement3 at, Displacement3 half) noexcept {
  const Displacement3 past{std::abs(at.x) - half.x, std::abs(at.y) - half.y,
                           std::abs(at.z) - half.z};
  if (past.x <= 0 && past.y <= 0 && past.z <= 0) {
    std::size_t nearest = 0;
    for (const std::size_t axis : {1U, 2U}) {
      if (past[axis] > past[nearest]) nearest = axis;
    }
    Outside out{past[nearest], {0, 0, 0}};
    out.outward[nearest] = toward(at[nearest]);
    return out;
  }
  Displacement3 away{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    away[axis] = toward(at[axis]) * std::max(0.0, past[axis]);
  }
  return from_core(away, 0);
}

Outside from_cylinder(Displacement3 at, double radius_m, double half_m) noexcept {
  const double level_m = std::hypot(at.x, at.z);
  const Direction3 side =
      level_m > 0 ? Direction3{at.x / level_m, 0, at.z / level_m} : Direction3{1, 0, 0};
  const double past_side_m = level_m - radius_m;
  const double past_end_m = std::abs(at.y) - half_m;
  if (past_side_m <= 0 && past_end_m <= 0) {
    if (past_side_m > past_end_m) return {past_side_m, side};
    return {past_end_m, {0, toward(at.y), 0}};
  }
  Displacement3 away = along<DisplacementTag>(side, std::max(0.0, past_side_m));
  away.y = toward(at.y) * std::max(0.0, past_end_m);
  return from_core(away, 0);
}

}  // namespace

PlacedShape::PlacedShape(const Shape& shape) noexcept
    : shape_(shape), to_world_(matrix_of(shape.turn_rad)) {
  shape_.radius_m = std::max(shape.radius_m, kLeastShape_m);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    shape_.half_m[axis] = std::max(shape.half_m[axis], kLeastShape_m / 2);
  }
}

bool PlacedShape::is_sound(const Shape& shape) noexcept {
  if (!is_finite(shape.center) || !is_finite(shape.turn_rad) || !is_finite(shape.half_m) ||
      !std::isfinite(shape.radius_m)) {
    return false;
  }
  const Displacement3& half = shape.half_m;
  const bool is_round = shape.radius_m >= kLeastShape_m;
  switch (shape.kind) {
    case ShapeKind::Sphere:
      return is_round;
    case ShapeKind::Box:
      return std::min({half.x, half.y, half.z}) >= kLeastShape_m / 2;
    case ShapeKind::Capsule:
    case ShapeKind::Cylinder:
      return is_round && half.y >= kLeastShape_m / 2;
    case ShapeKind::Floor:
      return true;
  }
  return false;
}

Outside PlacedShape::look(Position3 at) const noexcept {
  const Displacement3 from = at - shape_.center;
  const auto& row = to_world_.row;
  Displacement3 own{};
  for (std::size_t i = 0; i < 3; ++i) {
    own[i] = row[0][i] * from.x + row[1][i] * from.y + row[2][i] * from.z;
  }
  Outside out{own.y, {0, 1, 0}};
  switch (shape_.kind) {
    case ShapeKind::Sphere:
      out = from_core(own, shape_.radius_m);
      break;
    case ShapeKind::Box:
      out = from_box(own, shape_.half_m);
      break;
    case ShapeKind::Capsule:
      own.y -= std::clamp(own.y, -shape_.half_m.y, shape_.half_m.y);
      out = from_core(own, shape_.radius_m);
      if (own == Displacement3{}) out.outward = {1, 0, 0};  // on its axis: the side is nearest
      break;
    case ShapeKind::Cylinder:
      out = from_cylinder(own, shape_.radius_m, shape_.half_m.y);
      break;
    case ShapeKind::Floor:
      break;
  }
  const Direction3 n = out.outward;
  for (std::size_t i = 0; i < 3; ++i) {
    out.outward[i] = row[i][0] * n.x + row[i][1] * n.y + row[i][2] * n.z;
  }
  return out;
}

}  // namespace thimble::world
