#include "daemon/world/io/volume_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/unit/world/grids.hpp"

namespace thimble::world {
namespace {

using Order = std::array<std::uint8_t, 3>;
constexpr std::array<Order, 6> kOrders{
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

// A volume of random bits with a random shape, and what it should become.
struct RandomVolume {
  explicit RandomVolume(unsigned seed) : random(seed) {
    std::uniform_int_distribution<std::uint32_t> size(1, 9);
    for (auto& n : shape.sizes) n = size(random);
    const Order fastest = kOrders[random() % 6];
    for (std::size_t i = 0; i < 3; ++i) shape.fastest[i] = fastest[i];
    options.axis_order = kOrders[random() % 6];
    for (bool& is_reversed : options.is_reversed) is_reversed = random() % 2 == 0;
    values.resize(std::size_t{shape.sizes[0]} * shape.sizes[1] * shape.sizes[2]);
    for (double& value : values) value = random() % 2 == 0 ? 1 : 0;
  }

  // The number at an index along each axis of the file.
  [[nodiscard]] double at(const std::array<std::uint32_t, 3>& index) const {
    const auto [a, b, c] = shape.fastest;
    return values[index[a] + shape.sizes[a] * (index[b] + std::size_t{shape.sizes[b]} * index[c])];
  }

  // The number whose place is nearest to the middle of the cell, axis by axis; false when two are
  // equally near.
  [[nodiscard]] bool nearest(const VoxelGrid& grid, Cell cell, double& out) const {
    std::array<std::uint32_t, 3> index{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t to = options.axis_order[axis];
      const double along = (cell[to] + 0.5) / grid.cells()[to];
      const double middle = options.is_reversed[axis] ? 1 - along : along;
      double best = 2;
      bool is_tied = false;
      for (std::uint32_t i = 0; i < shape.sizes[axis]; ++i) {
        const double away = std::abs((i + 0.5) / shape.sizes[axis] - middle);
        is_tied = is_tied ? away > best - 1e-9 : std::abs(away - best) < 1e-9;
        if (away < best) index[axis] = i;
        best = std::min(best, away);
      }
      if (is_tied) return false;
    }
    out = at(index);
    return true;
  }

  [[nodiscard]] Result<VoxelGrid> write() {
    auto writer = VolumeWriter::create(shape, options);
    if (!writer) return tl::unexpected(writer.error());
    std::span<const double> rest(values);
    while (!rest.empty()) {
      const std::size_t count = 1 + random() % rest.size();
      if (auto put = writer->put(rest.first(count)); !put) return tl::unexpected(put.error());
      rest = rest.subspan(count);
    }
    EXPECT_EQ(writer->items_left(), 0U);
    return std::move(*writer).finish();
  }

  std::mt19937 random;
  VolumeShape shape;
  VolumeOptions options;
  std::vector<double> values;
};

TEST(VolumeWriter, PutsEveryNumberWhereTheAxisOrderSays) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomVolume volume(seed);
    const auto sut = volume.write();
    ASSERT_TRUE(sut);
    for_each_cell(*sut, [&](Cell cell) {
      std::array<std::uint32_t, 3> index{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        index[axis] = static_cast<std::uint32_t>(cell[volume.options.axis_order[axis]]);
        if (!volume.options.is_reversed[axis]) continue;
        index[axis] = volume.shape.sizes[axis] - 1 - index[axis];
      }
      ASSERT_EQ(sut->is_occupied(cell), volume.at(index) > 0) << seed;
    });
  }
}

TEST(VolumeWriter, FillsCubesFromTheNearestNumberWhereSpacingDiffers) {
  int compared = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    RandomVolume volume(seed);
    std::uniform_real_distribution<double> spacing(0.2, 2);
    for (double& s : volume.shape.spacing) s = spacing(volume.random);
    const auto sut = volume.write();
    ASSERT_TRUE(sut);
    const double finest =
        *std::min_element(volume.shape.spacing.begin(), volume.shape.spacing.end());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double wanted = volume.shape.sizes[axis] * volume.shape.spacing[axis] / finest;
      EXPECT_NEAR(sut->cells()[volume.options.axis_order[axis]], wanted, 0.5 + 1e-9);
    }
    for_each_cell(*sut, [&](Cell cell) {
      double value = 0;
      if (!volume.nearest(*sut, cell, value)) return;
      ASSERT_EQ(sut->is_occupied(cell), value > 0) << seed;
      ++compared;
    });
  }
  EXPECT_GT(compared, 100000);
}

TEST(VolumeWriter, NeverLosesAnOccupiedNumber) {
  for (const double spacing : {1.0, 1.01, 1.49, 1.51, 3.0, 17.3}) {
    VolumeShape shape{.sizes = {7, 1, 1}, .spacing = {spacing, 1, 1}};
    for (std::size_t occupied = 0; occupied < 7; ++occupied) {
      auto writer = VolumeWriter::create(shape, {});
      ASSERT_TRUE(writer);
      std::vector<double> values(7, 0);
      values[occupied] = 1;
      ASSERT_TRUE(writer->put(values));
      int cells = 0;
      const auto sut = std::move(*writer).finish();
      for_each_cell(sut, [&](Cell cell) { cells += sut.is_occupied(cell) ? 1 : 0; });
      EXPECT_GE(cells, 1) << spacing << " " << occupied;
    }
  }
}

TEST(VolumeWriter, TheOptionsSpacingReplacesTheFiles) {
  VolumeOptions options{.spacing = std::array{1.0, 1.0, 2.0}};
  auto sut = VolumeWriter::create({.sizes = {4, 4, 4}, .spacing = {9, 1, 1}}, options);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->items_left(), 64U);
  EXPECT_EQ(std::move(*sut).finish().cells(), (std::array<std::uint32_t, 3>{4, 4, 8}));
}

TEST(VolumeWriter, CellsMeasureWhatIsAskedOrFillTheWorkspace) {
  const VolumeShape shape{.sizes = {4, 8, 2}, .spacing = {1, 1, 8}};
  auto fitted = VolumeWriter::create(shape, {.workspace_m = 0.16});
  ASSERT_TRUE(fitted);
  EXPECT_DOUBLE_EQ(std::move(*fitted).finish().cell_m(), 0.01);
  auto asked = VolumeWriter::create(shape, {.workspace_m = 0.16, .cell_m = 0.003});
  ASSERT_TRUE(asked);
  EXPECT_DOUBLE_EQ(std::move(*asked).finish().cell_m(), 0.003);
}

TEST(VolumeWriter, RefusesSpacingThatGivesNoGrid) {
  const auto error_of = [](std::array<double, 3> spacing) {
    const auto sut = VolumeWriter::create({.sizes = {4, 4, 300}, .spacing = spacing}, {});
    return sut ? std::string() : sut.error().message;
  };
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, kInfinite, std::nan("")}) {
    EXPECT_NE(error_of({1, bad, 1}), "") << bad;
  }
  EXPECT_EQ(error_of({1, 1, 4}),
            "spacing[2]: is 4.000000 times the finest, which asks for more cells than the limit "
            "of 1024");
  EXPECT_EQ(error_of({1e-300, 1, 1}), "spacing[1]: is more than 64 times the finest");
  EXPECT_EQ(error_of({1, 1, 3.4}), "");
}

TEST(VolumeWriter, RefusesAnOrderThatNamesAnAxisTwice) {
  const auto sut = VolumeWriter::create({.sizes = {1, 1, 1}}, {.axis_order = {0, 0, 2}});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::InvalidArgument);
}

TEST(VolumeWriter, LabelsCellsByTheFirstRangeThatFits) {
  const Material soft{{200}, {2}};
  const Material hard{{900}, {9}};
  VolumeOptions options{.axis_order = {2, 1, 0}};
  options.materials = {{5, 9, hard}, {1, 6, soft}};
  auto sut = VolumeWriter::create({.sizes = {4, 1, 1}, .spacing = {2, 1, 1}}, options);
  ASSERT_TRUE(sut);
  ASSERT_TRUE(sut->put(std::array{0.0, 1.0, 6.0, 10.0}));
  const MaterialMap map = sut->take_materials();
  const std::array expected{Material{}, Material{}, soft, soft, hard, hard, Material{}, Material{}};
  for (int z = 0; z < 8; ++z) {
    EXPECT_EQ(map.at({0, 0, z}), expected[static_cast<std::size_t>(z)]) << z;
  }
}

TEST(VolumeWriter, NamesTheFilesIndexOfANaN) {
  VolumeOptions options{.axis_order = {2, 1, 0}};
  auto sut = VolumeWriter::create({.sizes = {2, 3, 4}, .fastest = {2, 1, 0}}, options);
  ASSERT_TRUE(sut);
  std::vector<double> values(24, 0);
  values[3 + 4 * (1 + 3 * 1)] = std::nan("");
  EXPECT_EQ(sut->put(values).error().message, "volume[1, 1, 3]: is not a number");
}

}  // namespace
}  // namespace thimble::world
