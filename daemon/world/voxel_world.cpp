#include "daemon/world/voxel_world.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "daemon/world/push_out.hpp"

namespace thimble::world {
namespace {

// At the hand, if that is free; else at the nearest free place. The first of equally near ones.
[[nodiscard]] std::optional<GhostPoint> start_place(const VoxelGrid& grid, FreeRows& free_rows,
                                                    Position3 hand) noexcept {
  const Position3 near = grid.clamp_near(hand);
  Cell middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = static_cast<std::int32_t>(grid.cells()[axis] / 2);
  }
  if (const auto exit = find_exit(grid, {near, Position3{} - near, false, middle, kPushOutReach})) {
    return exit->at;
  }
  const auto cell = free_rows.nearest(grid, near);
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
    : grid_(std::move(grid)),
      materials_(std::move(materials)),
      free_rows_(grid_),
      occupied_(grid_.count_occupied()) {
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
    const auto place = is_full ? std::nullopt : start_place(grid_, free_rows_, hand);
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
  motion.cell = (*slot)->ghost.point.cell;
  paint((*slot)->ghost.point, motion);
  return motion;
}

std::size_t VoxelWorld::set_row(Cell from, std::int32_t end_x, std::uint8_t value) noexcept {
  if (value > 0) materials_.set_row(from, end_x, static_cast<std::uint8_t>(value - 1));
  const std::size_t changed = grid_.set_row(from, end_x, value > 0);
  if (changed > 0) note_changed(from);
  occupied_ = value > 0 ? occupied_ + changed : occupied_ - changed;
  return changed;
}

void VoxelWorld::assign(std::span<const std::uint64_t> occupied) noexcept {
  const auto before = grid_.words();
  const std::size_t cells = std::size_t{1} * info_.cells[0] * info_.cells[1] * info_.cells[2];
  const std::size_t words = std::min(before.size(), occupied.size());
  for (std::size_t i = 0; i < words; ++i) {
    const std::size_t left = cells - 64 * i;
    const std::uint64_t used = left >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
    const std::uint64_t changed = (before[i] ^ occupied[i]) & used;
    if (changed != 0) assign_word(i, changed);
  }
}

// `changed`: which of its cells are no more what they were.
void VoxelWorld::assign_word(std::size_t index, std::uint64_t changed) noexcept {
  const std::uint64_t after = grid_.words()[index] ^ changed;
  grid_.set_word(index, after);
  occupied_ += static_cast<std::size_t>(std::popcount(changed & after));
  occupied_ -= static_cast<std::size_t>(std::popcount(changed & ~after));
  const std::size_t along_x = info_.cells[0];
  std::size_t noted = ~std::size_t{0};
  for (std::uint64_t left = changed; left != 0; left &= left - 1) {
    const std::size_t cell = 64 * index + static_cast<std::size_t>(std::countr_zero(left));
    const std::size_t row = cell / along_x;
    const Cell at{static_cast<std::int32_t>(cell % along_x),
                  static_cast<std::int32_t>(row % info_.cells[1]),
                  static_cast<std::int32_t>(row / info_.cells[1])};
    if (materials_.count() > 0 && grid_.is_occupied(at)) materials_.set(at, 0);
    if (std::exchange(noted, row) != row) note_changed(at);
  }
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
    plane.temperature_kelvin = material.temperature_kelvin;
  }
}

std::optional<VoxelWorld::Probe>* VoxelWorld::find(ProbeId id) noexcept {
  for (auto& slot : probes_) {
    if (slot && slot->id == id) return &slot;
  }
  return nullptr;
}

}  // namespace thimble::world
