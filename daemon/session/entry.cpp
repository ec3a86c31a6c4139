#include "daemon/session/entry.hpp"

#include "daemon/world/voxel_grid.hpp"

namespace thimble::session {
namespace {

// Looks at whole layers, as long as it may.
class Layers {
 public:
  explicit Layers(const world::VoxelGrid& grid) : grid_(grid) {}

  // False, too, when it was not looked at to its end.
  [[nodiscard]] bool is_matter(std::size_t axis, std::uint32_t layer) {
    const std::size_t across = (axis + 1) % 3;
    const std::size_t along = (axis + 2) % 3;
    std::array<std::int32_t, 3> at{};
    at.at(axis) = static_cast<std::int32_t>(layer);
    for (std::uint32_t i = 0; i < grid_.cells().at(across); ++i) {
      at.at(across) = static_cast<std::int32_t>(i);
      for (std::uint32_t j = 0; j < grid_.cells().at(along); ++j) {
        at.at(along) = static_cast<std::int32_t>(j);
        if (looks_left_ == 0) return false;
        --looks_left_;
        if (!grid_.is_occupied({at[0], at[1], at[2]})) return false;
      }
    }
    return true;
  }

 private:
  const world::VoxelGrid& grid_;
  std::size_t looks_left_{kMostEntryLooks};
};

// From the first layer on that is not all matter, up to behind the last.
struct Span {
  std::uint32_t first{0};
  std::uint32_t end{0};
};

Span span_of(Layers& layers, const world::VoxelGrid& grid, std::size_t axis) {
  Span span{0, grid.cells().at(axis)};
  while (span.first < span.end && layers.is_matter(axis, span.first)) ++span.first;
  while (span.first < span.end && layers.is_matter(axis, span.end - 1)) --span.end;
  return span;
}

}  // namespace

servo::EntryBox entry_into(const world::World& world, const std::array<double, 3>& place_m) {
  const std::array<double, 3>& extent_m = world.info().extent_m;
  std::array<double, 3> center_m{};
  servo::EntryBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) box.half_m.at(axis) = extent_m.at(axis) / 2;
  if (const world::VoxelGrid* const grid = world.grid()) {
    Layers layers(*grid);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Span span = span_of(layers, *grid, axis);
      if (!(extent_m.at(axis) > 0) || span.first >= span.end) continue;
      const double low_m = grid->face_m(axis, static_cast<std::int32_t>(span.first));
      const double high_m = grid->face_m(axis, static_cast<std::int32_t>(span.end));
      center_m.at(axis) = (low_m + high_m) / 2;
      box.half_m.at(axis) = (high_m - low_m) / 2;
    }
  }
  box.center = {center_m[0] - place_m[0], center_m[1] - place_m[1], center_m[2] - place_m[2]};
  return box;
}

}  // namespace thimble::session
