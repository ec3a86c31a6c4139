#pragma once

#include <array>
#include <cstddef>

#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::world {

// A half-space as seen from a point: how far the point is past its plane, < 0 on its free side.
struct PastPlane {
  Direction3 normal{};  // points into the obstacle
  double past_m{0};     // n·q − d
};
using PastPlanes = rt::StaticVector<PastPlane, kMaxContactPlanes>;

// What takes a point to the nearest place that all planes leave free: q − g = Σ λ_i·n_i.
struct PlaneProjection {
  Displacement3 past{};                           // q − g
  std::array<double, kMaxContactPlanes> share{};  // λ_i >= 0, m; at most three of them > 0
  bool has_place{true};                           // false: the planes leave no place free
};

// The god-object of a point q (teleop.md 2(f), thesis 3.7.2): the g of least ½|g − q|² with
// n_i·g ≤ d_i for all planes. Its conditions: g = q − Σ λ_i·n_i, λ_i ≥ 0, and λ_i > 0 only where
// n_i·g = d_i. In space at most three are needed: every set of one, two and three planes is solved
// for, (NᵀN)·λ = Nᵀq − d, until one meets them.
//
// Exact within kPlaneTolerance_m. Planes that lie closer to parallel than 3e-5 rad count as
// parallel, three whose normals span no more than that as two. Planes that leave no place free:
// each pushes for itself, λ_i = max(0, n_i·q − d_i), so that a hand between two walls that overlap
// is held between them.
//
// Mirrored points give mirrored results to the bit; permuted axes and another order of the planes
// to rounding, since sums of three products are rounded in their order.
//
// Thread: any: pure. RT: THIMBLE_RT; at most 92 sets. Errors: none; finite in, finite out.
[[nodiscard]] THIMBLE_RT PlaneProjection project(const PastPlanes& planes) noexcept;

// Above the rounding of what a hand reaches; where planes meet at a sharp angle, what is left in
// one of them is a larger error of g, up to 3e4 times this.
inline constexpr double kPlaneTolerance_m = 1e-12;

}  // namespace thimble::world
