#include "cli/cells.hpp"

#include <gtest/gtest.h>

#include "daemon/world/io/nrrd_write.hpp"

namespace thimble::cli {
namespace {

TEST(WorldCellsAnswer, IsReadAsItWasWritten) {
  const std::string values("\0\1\2\3\77\0", 6);
  const std::vector<std::uint8_t> bytes(values.begin(), values.end());
  const auto cells = parse_cells(world::nrrd_of_bytes({3, 2, 1}, bytes));
  ASSERT_TRUE(cells) << cells.error().message;
  EXPECT_EQ(*cells, (WorldCells{{3, 2, 1}, 1, values}));
  const auto grid = world::VoxelGrid::create({9, 9, 9}, 0.01).value();
  EXPECT_EQ(parse_cells(world::nrrd_of_grid(grid, 30)).value(),
            (WorldCells{{3, 3, 3}, 3, std::string(27, '\0')}));
}

TEST(WorldCellsAnswer, AsALayoutHasNoParticles) {
  const WorldCells cells{{3, 1, 1}, 1, "\77\100\1"};
  const WorldCells layout = without_particles(cells);
  EXPECT_EQ(layout.values, std::string("\77\0\1", 3));
  EXPECT_EQ(parse_cells(to_nrrd(layout)).value(), layout);
  EXPECT_TRUE(to_npy(layout).ends_with(layout.values));
}

TEST(WorldCellsAnswer, ThatIsNoneIsRefused) {
  const std::string good = world::nrrd_of_bytes({2, 2, 2}, std::vector<std::uint8_t>(8));
  ASSERT_TRUE(parse_cells(good));
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_FALSE(parse_cells(good.substr(0, size))) << size;
  }
  EXPECT_EQ(parse_cells(good + "x").error().code, Errc::Malformed);
  const auto with = [](std::string_view type, std::string_view more) {
    return world::nrrd_head(type, {2, 2, 2}, more) + std::string(8, '\0');
  };
  EXPECT_TRUE(parse_cells(with("uint8", "")));
  EXPECT_FALSE(parse_cells(with("uint16", "")));
  EXPECT_FALSE(parse_cells(with("uint8", "spacings: 0.5 1 1\n")));
  EXPECT_FALSE(parse_cells(with("uint8", "spacings: 1e9 1 1\n")));
  EXPECT_FALSE(parse_cells(with("uint8", "data file: /etc/passwd\n")));
  EXPECT_FALSE(parse_cells(with("uint8", "byte skip: 1\n")));
  EXPECT_EQ(parse_cells(world::nrrd_head("uint8", {1024, 1024, 2})).error().code, Errc::TooLarge);
}

}  // namespace
}  // namespace thimble::cli
