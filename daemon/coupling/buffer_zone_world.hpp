#pragma once

#include <cstdint>

#include "daemon/coupling/probe_in_world.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/world/near_cell_finder.hpp"

namespace thimble::coupling {

// What the answer says of the zone (thesis 3.6).
enum class ZoneNames : std::uint8_t {
  Cells,  // "cells": the occupied ones nearby, figure 3-5b
  Faces,  // "faces": direction and distance, figure 3-4; blind to diagonals, figure 3-5a
};

struct BufferZoneWorldSettings {
  // d_buf. The thesis's box has cells of 30 mm, and so much is one of them: 0.25 m/s for 119 ms.
  double buffer_m{0.030};
  ZoneNames names{ZoneNames::Cells};
};

// The world half of teleoperation with buffer zones (thesis 3.6): a probe follows the hand as by
// GhostPointWorld, and the answer tells, before the hand is there, what is occupied within d_buf of
// the box between ghost and hand.
//
//   d_buf >= v_max·(D + Ts)     or, of a zone of n cells of edge c: n >= d_buf/c
//
// v_max  of the hand, m/s    D  from sample to answer, there and back, s    Ts  servo's period, s
//
// In metres and not in cells, so that a wall is told of at the same distance wherever the ghost is
// in its cell. d_buf is the configuration's and stays: the thesis's zone cannot follow the delay
// while it runs either.
//
// Faces: from the ghost's cell along both ways of each axis, the first face of an occupied cell:
// six planes at most, both of an axis where zones overlap (figure 3-5c). Cells: NearCellFinder.
// Where the world marks its zone (World::is_in_zone()), nothing is looked for outside it. A world
// that alone has its cells is asked for the faces (World::zone_faces()), which are as old as its
// last look: what it takes counts as delay in D. While matter fills the ghost's place the planes
// that push it out are told, and no zone.
//
// Thread: the world's thread. Not RT; answer() neither allocates nor blocks, and looks at no more
// cells than lie within world::kNearReach_cells.
// Ownership: `world` must outlive it, and have World::felt_cells(), or for Faces find them itself;
// the destructor closes.
// Sessions: as by GhostPointWorld.
// Errors: as RemoteForceWorld's.
class BufferZoneWorld final : public WorldCoupling {
 public:
  BufferZoneWorld(world::World& world, std::uint32_t first_session,
                  const BufferZoneWorldSettings& settings = {}) noexcept;

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { probe_.close(); }

 private:
  // To those of `motion`.
  void add_faces_found(const world::ProbeMotion& motion, Position3 hand) noexcept;
  [[nodiscard]] PlaneList faces_near(const world::ProbeMotion& motion,
                                     Position3 hand) const noexcept;

  world::World& world_;
  BufferZoneWorldSettings settings_;
  ProbeInWorld probe_;
  std::uint32_t next_session_;
  world::NearCellFinder finder_{};
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
