#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "daemon/world/cell.hpp"
#include "daemon/world/io/number_sink.hpp"
#include "daemon/world/material_map.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Occupied cells whose number is from `from` to `to`, ends included, are of this material; the
// first of several that fit counts.
struct MaterialRange {
  double from{0};
  double to{0};
  Material material{};
};

// What a configuration says of a volume file. "Axis i of the file": the i-th of its header.
struct VolumeOptions {
  double workspace_m{kDefaultWorkspace_m};          // spanned by the longest axis of the world
  double threshold{0};                              // a cell is occupied when its number is greater
  std::array<std::uint8_t, 3> axis_order{0, 1, 2};  // axis i of the file is this one of the world
  std::array<bool, 3> is_reversed{};                // axis i of the file runs against its axis
  std::optional<double> cell_m{};                   // edge of a cell, instead of workspace_m
  std::optional<std::array<double, 3>> spacing{};   // instead of the file's own
  std::vector<MaterialRange> materials{};
};

// Turns the numbers of a volume, as they come from a file, into occupancy. Cells are cubes of the
// finest spacing; along coarser axes a number fills the cells whose centres are nearest to it.
//
// Thread: one. Not RT. Holds the bits of the grid, the labels of a MaterialMap and 12 KiB.
// Errors: InvalidArgument, TooLarge for a shape or spacing that gives no grid; Malformed for NaN.
class VolumeWriter final : public NumberSink {
 public:
  [[nodiscard]] static Result<VolumeWriter> create(const VolumeShape& shape,
                                                   const VolumeOptions& options);
  // What create() would say, without its memory.
  [[nodiscard]] static Result<void> check(const VolumeShape& shape, const VolumeOptions& options);

  [[nodiscard]] std::uint64_t items_left() const noexcept override { return left_; }
  [[nodiscard]] Result<void> put(std::span<const double> values) override;
  // To be asked for when none is left.
  [[nodiscard]] VoxelGrid finish() && { return std::move(grid_); }
  [[nodiscard]] MaterialMap take_materials() noexcept { return std::move(materials_); }

 private:
  // Along one axis of the file, number i fills the cells from first[i] up to first[i + 1]; where
  // the axis is reversed, as far from the other end.
  class Axis {
   public:
    Axis() = default;
    Axis(std::size_t to, std::vector<std::int32_t> first, bool is_reversed)
        : to_(to), first_(std::move(first)), is_reversed_(is_reversed) {}
    [[nodiscard]] std::size_t to() const noexcept { return to_; }  // axis of the world
    [[nodiscard]] std::int32_t low(std::size_t i) const noexcept {
      return is_reversed_ ? first_.back() - first_[i + 1] : first_[i];
    }
    [[nodiscard]] std::int32_t high(std::size_t i) const noexcept {
      return is_reversed_ ? first_.back() - first_[i] : first_[i + 1];
    }

   private:
    std::size_t to_{0};
    std::vector<std::int32_t> first_;
    bool is_reversed_{false};
  };
  VolumeWriter(VoxelGrid grid, MaterialMap materials, const VolumeShape& shape,
               const VolumeOptions& options);
  void fill(std::size_t fast_index, double value) noexcept;
  [[nodiscard]] std::uint8_t label_of(double value) const noexcept;
  void put_cell(Cell cell, std::uint8_t label) noexcept;
  void next_row() noexcept;
  [[nodiscard]] std::string name_of(std::size_t fast_index) const;

  VoxelGrid grid_;
  MaterialMap materials_;
  std::vector<MaterialRange> ranges_;
  VolumeShape shape_;
  double threshold_;
  std::array<Axis, 3> axes_;
  bool is_one_to_one_{true};
  std::array<std::uint32_t, 3> at_{};  // index along each axis of the file
  Cell low_{}, high_{};                // what the current number fills, high_ excluded
  std::uint64_t left_{0};
};

// The occupancy of what `read` puts into the sink that it is given, and where `materials` is not
// null what the options say of them. Errors: those of `read` and of VolumeWriter.
[[nodiscard]] Result<VoxelGrid> write_volume(
    const std::function<Result<void>(const SinkMaker&)>& read, const VolumeOptions& options,
    MaterialMap* materials);

}  // namespace thimble::world
