#pragma once

#include "daemon/coupling/arm_link.hpp"

namespace thimble::coupling {

// An arm that stands elsewhere in its world than at the origin: what it sends is moved there, and
// what it is told from there, so that neither half knows. World frame = base frame + place, axes
// parallel. Forces, velocities, waves and impulses are the same in both.
//
// Thread, RT: as ArmLink. Ownership: the link must outlive it. Errors: none; cells
// (ConstraintSet::near, map) have no other place than theirs and are left out.
class PlacedLink final : public ArmLink {
 public:
  PlacedLink(ArmLink& link, Displacement3 place) noexcept : link_(link), place_(place) {}

  THIMBLE_RT_IO void send(const HandSample& sample) noexcept override {
    HandSample moved = sample;
    moved.hand = sample.hand + place_;
    if (sample.has_ghost) moved.ghost = sample.ghost + place_;
    link_.send(moved);
  }
  THIMBLE_RT bool receive(ConstraintSet& out) noexcept override {
    if (!link_.receive(out)) return false;
    for (ConstraintPlane& plane : out.planes) plane.offset_m -= dot(plane.normal, place_);
    if (out.has_ghost) out.ghost = out.ghost - place_;
    if (out.has_far) out.far.slave = out.far.slave - place_;
    out.has_near = false;
    out.has_map = false;
    out.has_ghost_cell = false;
    return true;
  }
  [[nodiscard]] THIMBLE_RT LinkQuality quality() const noexcept override { return link_.quality(); }

 private:
  ArmLink& link_;
  Displacement3 place_;
};

}  // namespace thimble::coupling
