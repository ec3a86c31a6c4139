#pragma once

#include <optional>

#include "daemon/world/fields/distance_field.hpp"
#include "daemon/world/material_map.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// Ours: a slide goes an eighth of the field's step a leg, so 32 steps in one move; then the ghost
// rests till the next move, outside as ever.
inline constexpr int kMaxFieldLegs = 256;

// Moves a ghost point through the free part of a field, where its distance is above 0: a god-object
// (thesis 3.7.2, teleop.md 2(f)). In free space it goes straight at the hand by steps of
// distance/steepest(), which pass no surface, however far the hand jumps. Touching, it slides along
// the tangent plane by no more than an eighth of the field's step, is lifted to the surface along
// the gradient, and keeps what is nearer to the hand; so it rests where no such slide leads nearer.
// A sheet of matter thinner than that eighth is not safe from a slide round a sharp edge of it.
//
// The planes that hold it: the tangent plane at its place, and in a dent those of the faces that
// places a step beside it along the axes see, turned by more than 25 degrees; seven at most. They
// leave the ghost free within what touches; where it rests, at least one holds it. An edge of a
// dent is rounded by about a step.
//
// RT: THIMBLE_RT; at most kMaxFieldLegs legs. Errors: none; a hand that is not finite leaves the
// ghost where it is and gives no planes.
THIMBLE_RT ProbeMotion move_ghost(const DistanceField& field, const Material& surface,
                                  Position3& ghost, Position3 hand) noexcept;

// As find_free_place(), then as near to the hand as a ghost gets from there. `hand` finite.
[[nodiscard]] std::optional<Position3> find_place(const DistanceField& field,
                                                  Position3 hand) noexcept;

}  // namespace thimble::world
