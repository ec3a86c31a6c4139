#pragma once

#include "daemon/world/sphere_scene.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::world {

// A ghost point outside all matter, and the surfaces that it is on.
struct SphereGhost {
  Position3 position{};
  bool is_on_sphere{false};
  bool is_on_floor{false};
  bool operator==(const SphereGhost&) const = default;
};

// At `hand` where that is free, else at the nearest free place. `hand` finite.
[[nodiscard]] SphereGhost place_ghost(const SphereScene& scene, Position3 hand) noexcept;

// Moves the ghost the way on which its distance to the hand falls fastest: straight through free
// space, along great circles of the ball, straight over the floor, and round the ring where the two
// meet; to where no way leads nearer. Each leg is exact, so nothing is passed through, whatever the
// step. A plane of the result is the tangent plane at the ghost of a surface that holds it back.
//
// RT: THIMBLE_RT; at most kMaxLegs legs, then it rests till the next move, outside as ever.
// Errors: none; a hand that is not finite leaves the ghost where it is and gives no planes.
THIMBLE_RT ProbeMotion move_ghost(const SphereScene& scene, SphereGhost& ghost,
                                  Position3 hand) noexcept;

// Ours: free space, ball, ring, ball, free space, floor is the longest way that a ball and a floor
// ask for; twice that.
inline constexpr int kMaxLegs = 12;

}  // namespace thimble::world
