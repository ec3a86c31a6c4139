#include "daemon/coupling/buffer_zone_world.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/coupling/tell.hpp"

namespace thimble::coupling {

BufferZoneWorld::BufferZoneWorld(world::World& world, std::uint32_t first_session,
                                 const BufferZoneWorldSettings& settings) noexcept
    : world_(world), settings_(settings), probe_(world), next_session_(first_session) {}

Result<void> BufferZoneWorld::open(const HandSample& first) {
  const bool is_of_cells = world_.felt_cells() != nullptr;
  const bool names_faces = settings_.names == ZoneNames::Faces;
  if (!is_of_cells && !(names_faces && world_.finds_zone_faces())) {
    return fail(Errc::Unsupported, world_.info().source + ": a buffer zone is made of cells");
  }
  if (Result<void> opened = probe_.open(first); !opened) return opened;
  world_.mark_zone(world::zone_cells(settings_.buffer_m, world_.info().cell_m));
  last_ = {};
  last_.session = next_session_++;
  return {};
}

ConstraintSet BufferZoneWorld::answer(const HandSample& sample, Duration dt) noexcept {
  if (!probe_.is_open() || sample.sequence <= last_.answers) return last_;
  const auto moved = follow_and_tell(probe_, sample, dt, last_);
  if (!moved) return last_;
  const world::ProbeMotion& motion = *moved;
  last_.has_near = false;
  last_.is_astray = false;
  if (motion.is_embedded) return last_;
  if (settings_.names == ZoneNames::Faces) {
    if (world_.felt_cells() == nullptr) {
      add_faces_found(motion, sample.hand);
    } else {
      last_.planes = faces_near(motion, sample.hand);
    }
    return last_;
  }
  last_.has_near = true;
  last_.is_astray = sample.has_ghost && sample.ghost != motion.ghost;
  const world::VoxelGrid& grid = *world_.felt_cells();
  const world::NearQuery query{motion.cell, motion.ghost, sample.hand, settings_.buffer_m,
                               world_.is_plane()};
  last_.near = world_.is_in_zone(motion.cell) ? finder_.find(grid, query)
                                              : world::NearCellFinder::nothing(grid, query);
  return last_;
}

void BufferZoneWorld::add_faces_found(const world::ProbeMotion& motion, Position3 hand) noexcept {
  for (const world::ContactPlane& face : world_.zone_faces()) {
    const double at_m = std::max(dot(face.normal, motion.ghost), dot(face.normal, hand));
    if (face.offset_m > at_m + settings_.buffer_m) continue;
    // What holds the ghost is known better: the world has just looked.
    const bool holds =
        std::any_of(last_.planes.begin(), last_.planes.end(),
                    [&face](const ConstraintPlane& plane) { return plane.normal == face.normal; });
    if (!holds) last_.planes.push_back(plane_of(face));
  }
}

PlaneList BufferZoneWorld::faces_near(const world::ProbeMotion& motion,
                                      Position3 hand) const noexcept {
  PlaneList planes;
  if (!world_.is_in_zone(motion.cell)) return planes;
  const world::VoxelGrid& grid = *world_.felt_cells();
  const Position3 near_hand = grid.clamp_near(hand);
  for (std::size_t axis = 0; axis < (world_.is_plane() ? 2U : 3U); ++axis) {
    for (const std::int32_t way : {1, -1}) {
      const double reach_m =
          std::max(way * motion.ghost[axis], way * near_hand[axis]) + settings_.buffer_m;
      world::Cell cell = motion.cell;
      for (std::int32_t i = 0; i < world::kNearReach_cells; ++i) {
        const double face_m = way * grid.face_m(axis, cell[axis] + (way > 0 ? 1 : 0));
        if (face_m > reach_m) break;
        cell[axis] += way;
        if (!grid.is_occupied(cell)) continue;
        ConstraintPlane plane{.offset_m = face_m};
        plane.normal[axis] = way;
        planes.push_back(plane);
        break;
      }
    }
  }
  return planes;
}

}  // namespace thimble::coupling
