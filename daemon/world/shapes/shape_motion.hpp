#pragma once

#include <optional>
#include <span>

#include "daemon/world/shapes/shape.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// What is nearer to a shape touches it. Far below what is felt.
inline constexpr double kTouch_m = 1e-7;
// Ours: a slide over a curved shape takes about five legs; then the ghost rests till the next move,
// outside as ever.
inline constexpr int kMaxShapeLegs = 64;

// Moves a ghost point through the union of `shapes`, of which it is outside: a god-object (thesis
// 3.7.2, teleop.md 2(f)). It goes straight at the hand as far as the shapes that it touches let it
// (plane_projection.hpp, with their tangent planes), leg by leg, until no way leads nearer. The
// shapes are convex, so that a leg of distance/fall toward each of them cannot pass its surface:
// nothing is tunnelled through, however thin it is and however far the hand jumps.
//
// The planes of the result are the tangent planes of what holds the ghost back, at most three of
// different shapes, each with its shape's surface.
//
// RT: THIMBLE_RT; at most kMaxShapeLegs legs of one look at each shape. Errors: none; a hand that
// is not finite leaves the ghost where it is and gives no planes.
THIMBLE_RT ProbeMotion move_ghost(std::span<const PlacedShape> shapes, Position3& ghost,
                                  Position3 hand) noexcept;

// At `hand` where that is free, else at a free place near it; none where none was found within 10 m
// in any of 26 directions. `hand` finite. Control plane: takes up to some milliseconds.
[[nodiscard]] std::optional<Position3> find_place(std::span<const PlacedShape> shapes,
                                                  Position3 hand) noexcept;

}  // namespace thimble::world
