#include "daemon/world/io/volume_writer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace thimble::world {
namespace {

// Ours: thicker slices are a mistake in the header, and a small file must not become a large world.
constexpr double kMaxSpacingRatio = 64;

[[nodiscard]] Result<std::array<std::uint32_t, 3>> cells_along_file(
    const VolumeShape& shape, const std::array<double, 3>& spacing) {
  const double finest = *std::min_element(spacing.begin(), spacing.end());
  std::array<std::uint32_t, 3> cells{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string field = "spacing[" + std::to_string(axis) + "]";
    const double ratio = spacing[axis] / finest;
    if (!(finest > 0) || !std::isfinite(spacing[axis])) {
      return fail(Errc::InvalidArgument, field + ": is not a length greater than 0");
    }
    if (!(ratio <= kMaxSpacingRatio)) {
      return fail(Errc::TooLarge, field + ": is more than 64 times the finest");
    }
    const double count = std::round(shape.sizes[axis] * ratio);
    if (count > VoxelGrid::kMaxCellsPerAxis) {
      return fail(Errc::TooLarge, field + ": is " + std::to_string(ratio) +
                                      " times the finest, which asks for more cells than the "
                                      "limit of " +
                                      std::to_string(VoxelGrid::kMaxCellsPerAxis));
    }
    cells[axis] = static_cast<std::uint32_t>(count);
  }
  return cells;
}

// first[i]: the first of `cells` equal parts whose centre is in the i-th of `count` or beyond.
[[nodiscard]] std::vector<std::int32_t> firsts(std::uint32_t count, std::uint32_t cells) {
  std::vector<std::int32_t> first(count + std::size_t{1}, static_cast<std::int32_t>(cells));
  for (std::uint32_t cell = cells; cell-- > 0;) {
    const std::uint64_t from = (2 * std::uint64_t{cell} + 1) * count / (2 * std::uint64_t{cells});
    first[static_cast<std::size_t>(from)] = static_cast<std::int32_t>(cell);
  }
  return first;
}

[[nodiscard]] bool is_permutation_of_axes(const std::array<std::uint8_t, 3>& order) noexcept {
  return std::is_permutation(order.begin(), order.end(),
                             std::array<std::uint8_t, 3>{0, 1, 2}.begin());
}

struct Plan {
  std::array<std::uint32_t, 3> cells{};
  double cell_m{0};
};

[[nodiscard]] Result<Plan> plan(const VolumeShape& shape, const VolumeOptions& options) {
  if (!is_permutation_of_axes(options.axis_order)) {
    return fail(Errc::InvalidArgument, "axis order: is no order of x, y and z");
  }
  const auto along_file = cells_along_file(shape, options.spacing.value_or(shape.spacing));
  if (!along_file) return tl::unexpected(along_file.error());
  Plan out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.cells[options.axis_order[axis]] = (*along_file)[axis];
  }
  const std::uint32_t longest = *std::max_element(out.cells.begin(), out.cells.end());
  out.cell_m = options.cell_m.value_or(options.workspace_m / longest);
  return out;
}

}  // namespace

VolumeWriter::VolumeWriter(VoxelGrid grid, MaterialMap materials, const VolumeShape& shape,
                           const VolumeOptions& options)
    : grid_(std::move(grid)),
      materials_(std::move(materials)),
      ranges_(options.materials),
      shape_(shape),
      threshold_(options.threshold) {
  left_ = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t to = options.axis_order[axis];
    const std::uint32_t count = shape.sizes[axis];
    axes_[axis] = Axis(to, firsts(count, grid_.cells()[to]), options.is_reversed[axis]);
    is_one_to_one_ = is_one_to_one_ && count == grid_.cells()[to];
    left_ *= count;
    low_[to] = axes_[axis].low(0);
    high_[to] = axes_[axis].high(0);
  }
}

Result<void> VolumeWriter::check(const VolumeShape& shape, const VolumeOptions& options) {
  const auto planned = plan(shape, options);
  if (!planned) return tl::unexpected(planned.error());
  return VoxelGrid::check(planned->cells, planned->cell_m);
}

Result<VolumeWriter> VolumeWriter::create(const VolumeShape& shape, const VolumeOptions& options) {
  const auto planned = plan(shape, options);
  if (!planned) return tl::unexpected(planned.error());
  auto grid = VoxelGrid::create(planned->cells, planned->cell_m);
  if (!grid) return tl::unexpected(grid.error());
  std::vector<Material> materials;
  for (const MaterialRange& range : options.materials) materials.push_back(range.material);
  auto map = MaterialMap::create(planned->cells, materials);
  if (!map) return tl::unexpected(map.error());
  return VolumeWriter(std::move(*grid), std::move(*map), shape, options);
}

Result<void> VolumeWriter::put(std::span<const double> values) {
  const std::size_t fast = shape_.fastest[0];
  while (!values.empty() && left_ > 0) {
    const std::size_t start = at_[fast];
    const std::size_t count = std::min<std::size_t>(values.size(), shape_.sizes[fast] - start);
    for (std::size_t i = 0; i < count; ++i) {
      if (values[i] > threshold_) {
        fill(start + i, values[i]);
      } else if (std::isnan(values[i])) {
        return fail(Errc::Malformed, name_of(start + i) + ": is not a number");
      }
    }
    values = values.subspan(count);
    left_ -= count;
    at_[fast] = static_cast<std::uint32_t>(start + count);
    if (at_[fast] == shape_.sizes[fast]) next_row();
  }
  return {};
}

std::uint8_t VolumeWriter::label_of(double value) const noexcept {
  const auto fits = std::find_if(ranges_.begin(), ranges_.end(), [&](const MaterialRange& range) {
    return value >= range.from && value <= range.to;
  });
  return fits == ranges_.end() ? std::uint8_t{0}
                               : static_cast<std::uint8_t>(fits - ranges_.begin() + 1);
}

void VolumeWriter::put_cell(Cell cell, std::uint8_t label) noexcept {
  grid_.set_occupied(cell, true);
  if (label != 0) materials_.set(cell, label);
}

void VolumeWriter::fill(std::size_t fast_index, double value) noexcept {
  const std::uint8_t label = label_of(value);
  const Axis& fast = axes_[shape_.fastest[0]];
  low_[fast.to()] = fast.low(fast_index);
  if (is_one_to_one_) return put_cell(low_, label);
  high_[fast.to()] = fast.high(fast_index);
  for (Cell cell = low_; cell.z < high_.z; ++cell.z) {
    for (cell.y = low_.y; cell.y < high_.y; ++cell.y) {
      for (cell.x = low_.x; cell.x < high_.x; ++cell.x) put_cell(cell, label);
    }
  }
}

void VolumeWriter::next_row() noexcept {
  at_[shape_.fastest[0]] = 0;
  for (const std::size_t axis : {shape_.fastest[1], shape_.fastest[2]}) {
    if (++at_[axis] == shape_.sizes[axis]) at_[axis] = 0;
    low_[axes_[axis].to()] = axes_[axis].low(at_[axis]);
    high_[axes_[axis].to()] = axes_[axis].high(at_[axis]);
    if (at_[axis] != 0) return;
  }
}

std::string VolumeWriter::name_of(std::size_t fast_index) const {
  auto at = at_;
  at[shape_.fastest[0]] = static_cast<std::uint32_t>(fast_index);
  return "volume[" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " +
         std::to_string(at[2]) + "]";
}

Result<VoxelGrid> write_volume(const std::function<Result<void>(const SinkMaker&)>& read,
                               const VolumeOptions& options, MaterialMap* materials) {
  std::optional<VolumeWriter> writer;
  const auto done = read([&](const VolumeShape& shape) -> Result<NumberSink*> {
    auto made = VolumeWriter::create(shape, options);
    if (!made) return tl::unexpected(made.error());
    writer.emplace(std::move(*made));
    return &*writer;
  });
  if (!done) return tl::unexpected(done.error());
  if (materials != nullptr) *materials = writer->take_materials();
  return std::move(*writer).finish();
}

}  // namespace thimble::world
