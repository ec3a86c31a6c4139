#include "daemon/world/voxel_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "daemon/world/push_out.hpp"

namespace thimble::world {
namespace {

[[nodiscard]] double distance_to_cell_m(const VoxelGrid& grid, std::size_t axis, std::int32_t index,
                                        double p) noexcept {
  return std::max({0.0, grid.face_m(axis, index) - p, p - grid.face_m(axis, index + 1)});
}

// Every free cell of one row, as far as it can still be the nearest.
void search_row(const VoxelGrid& grid, Position3 p, Cell row, double row2_m2,
                std::pair<double, std::optional<Cell>>& best) noexcept {
  const auto end = static_cast<std::int32_t>(grid.cells()[0]);
  for (row.x = grid.next_free_in_row(row); row.x < end;
       ++row.x, row.x = grid.next_free_in_row(row)) {
    const double dx_m = distance_to_cell_m(grid, 0, row.x, p.x);
    const double distance2_m2 = row2_m2 + dx_m * dx_m;
    if (!best.second || distance2_m2 < best.first) best = {distance2_m2, row};
  }
}

// The nearest free cell of the whole grid. Walks it all but for rows too far away.
[[nodiscard]] std::optional<Cell> nearest_free_cell(const VoxelGrid& grid, Position3 p) noexcept {
  std::pair<double, std::optional<Cell>> best{std::numeric_limits<double>::infinity(), {}};
  const auto rows = static_cast<std::int32_t>(grid.cells()[1]);
  const auto layers = static_cast<std::int32_t>(grid.cells()[2]);
  for (Cell row; row.z < layers; ++row.z) {
    const double dz_m = distance_to_cell_m(grid, 2, row.z, p.z);
    for (row.y = 0; row.y < rows; ++row.y) {
      const double dy_m = distance_to_cell_m(grid, 1, row.y, p.y);
      const double row2_m2 = dy_m * dy_m + dz_m * dz_m;
      if (row2_m2 < best.first) search_row(grid, p, row, row2_m2, best);
    }
  }
  return best.second;
}

// At the hand, if that is free; else at the nearest free place. The first of equally near ones.
[[nodiscard]] std::optional<GhostPoint> start_place(const VoxelGrid& grid,
                                                    Position3 hand) noexcept {
  const Position3 near = grid.clamp_near(hand);
  Cell middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = static_cast<std::int32_t>(grid.cells()[axis] / 2);
  }
  if (const auto exit = find_exit(grid, {near, Position3{} - near, false, middle, kPushOutReach})) {
    return exit->at;
  }
  const auto cell = nearest_free_cell(grid, near);
  if (!cell) return std::nullopt;
  GhostPoint place{near, *cell};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place.position[axis] = std::clamp(near[axis], grid.face_m(axis, (*cell)[axis]),
                                      grid.face_m(axis, (*cell)[axis] + 1));
  }
  return place;
}

}  // namespace

VoxelWorld::VoxelWorld(VoxelGrid grid, std::string source, MaterialMap materials)
    : grid_(std::move(grid)), materials_(std::move(materials)), occupied_(grid_.count_occupied()) {
  info_.source = std::move(source);
  info_.cells = grid_.cells();
  info_.cell_m = grid_.cell_m();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    info_.extent_m[axis] = -2 * grid_.face_m(axis, 0);
  }
}

Result<ProbeId> VoxelWorld::add_probe(Position3 hand) {
  if (!is_finite(hand)) return fail(Errc::InvalidArgument, "probe: the hand's place is not finite");
  const bool is_full =
      occupied_ == std::size_t{1} * info_.cells[0] * info_.cells[1] * info_.cells[2];
  for (auto& slot : probes_) {
    if (slot) continue;
    // Of a full world it is known; the search would walk all of it to say the same.
    const auto place = is_full ? std::nullopt : start_place(grid_, hand);
    if (!place) return fail(Errc::NotFound, info_.source + ": the world has no free cell");
    const bool is_held_back = place->position != hand;
    slot = Probe{{++last_id_}, {*place, GhostPhase::Loose, is_held_back}};
    return slot->id;
  }
  return fail(Errc::Busy, info_.source + ": all " + std::to_string(kMaxProbes) +
                              " probes of the world are taken");
}

void VoxelWorld::remove_probe(ProbeId probe) noexcept {
  if (auto* slot = find(probe)) slot->reset();
}

ProbeMotion VoxelWorld::move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept {
  auto* slot = find(probe);
  if (slot == nullptr) return {hand, {}, false};
  ProbeMotion motion = move_ghost(grid_, (*slot)->ghost, hand, dt);
  paint((*slot)->ghost.point, motion);
  return motion;
}

std::size_t VoxelWorld::set_row(Cell from, std::int32_t end_x, std::uint8_t value) noexcept {
  if (value > 0) materials_.set_row(from, end_x, static_cast<std::uint8_t>(value - 1));
  const std::size_t changed = grid_.set_row(from, end_x, value > 0);
  occupied_ = value > 0 ? occupied_ + changed : occupied_ - changed;
  return changed;
}

// A plane belongs to the cell beyond it; a ghost in matter is held by the cell that it is in.
void VoxelWorld::paint(const GhostPoint& ghost, ProbeMotion& motion) const noexcept {
  for (ContactPlane& plane : motion.planes) {
    Cell touched = ghost.cell;
    if (!grid_.is_occupied(touched)) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (plane.normal[axis] != 0) touched[axis] += plane.normal[axis] > 0 ? 1 : -1;
      }
    }
    const Material& material = materials_.at(touched);
    plane.stiffness = material.stiffness;
    plane.damping = material.damping;
    plane.friction = material.friction;
  }
}

std::optional<VoxelWorld::Probe>* VoxelWorld::find(ProbeId id) noexcept {
  for (auto& slot : probes_) {
    if (slot && slot->id == id) return &slot;
  }
  return nullptr;
}

}  // namespace thimble::world
