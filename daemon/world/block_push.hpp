#pragma once

#include <cstddef>

#include "hal/base/geometry.hpp"

namespace thimble::world {

// How a block in a room of oil goes on under one hand (BlockWorld), for the time of one step:
//
//   B·ds/dt = n·K·x + F_t + w      ds/dt of the block, m/s
//
// K, B  stiffness of its face, drag of the oil: N/m, N·s/m    x  depth of the hand behind it, m
// n     into the block, the hand's way                        w  what pulls the block, N
// F_t   friction, N: K·e, and |F_t| <= μ·K·x                  e  from where the hand sticks, m
//
// Along n, and along the face where it sticks, that is a spring and a drag, solved exactly:
// with k = K/B, x_∞ = −w_n/K, e_∞ = −w_t/K:
//
//   x(t) = x_∞ + (x − x_∞)·e^(−k·t)       until the block leaves the hand, x = 0: then w alone
//   e(t) = e_∞ + (e − e_∞)·e^(−k·t)
//
// Friction is judged by its impulse, for a step may be long: where sticking would take more than
// J = μ·K·∫x dt, it slips, and gives J towards the hand. Then |e| <= μ·x again: its foot slips
// (decision 0129). So it is in one step what it is in many, as long as the hand rests.
//
// Pure. Frame: the world's. Mirrored and permuted input gives the same output, to the bit, mirrored
// and permuted. Errors: none; finite in, finite out.
struct BlockOil {
  double stiffness_newton_per_m{0};  // > 0
  double drag_newton_s_per_m{0};     // > 0
  double friction{0};                // >= 0
  double most_m{0};                  // of the block's center on either side, along each axis
};
struct BlockHold {
  std::size_t axis{0};      // across the face
  int sign{1};              // of n
  double depth_m{0};        // >= 0
  Displacement3 stretch{};  // e; 0 along the axis
};
struct BlockMotion {
  Position3 center{};
  BlockHold hold{};  // as it is then
};

[[nodiscard]] BlockMotion push_block(const BlockOil& oil, const BlockHold& hold, Position3 center,
                                     Force3 weight, double dt_s) noexcept;

// That nobody holds.
[[nodiscard]] Position3 sink_block(const BlockOil& oil, Position3 center, Force3 weight,
                                   double dt_s) noexcept;

}  // namespace thimble::world
