#include "cli/picture/picture.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "cli/picture/snapshot.hpp"

namespace thimble::picture {
namespace {

struct Read {
  std::uint32_t matter, seen, light, shade, rest;
  bool operator==(const Read&) const = default;
};
Read read(std::uint32_t site) {
  return {site & 7, site >> 3 & 7, site >> 6 & 7, site >> 9 & 7, site >> 12};
}

TEST(RenderRule, TheFirstCellIsSeenInTheLightThatCameThere) {
  for (std::uint32_t n = 0; n < 65536; ++n) {
    const Read before = read(n);
    Read expected = before;
    expected.matter = 0;
    if (before.matter != 0) {
      if (before.seen == 0) {
        expected.seen = before.matter;
        expected.shade = before.light;
      }
      expected.light = std::min(before.light + 1, 7U);
    }
    ASSERT_EQ(read(render_rule(n)), expected) << n;
  }
}

ColorVolume random_volume(std::array<std::size_t, 3> cells, unsigned one_in, std::mt19937& random) {
  ColorVolume volume{cells, std::vector<std::uint8_t>(cells[0] * cells[1] * cells[2])};
  for (auto& color : volume.colors) {
    color = static_cast<std::uint8_t>(random() % one_in == 0 ? 1 + random() % 7 : 0);
  }
  return volume;
}

std::uint32_t color_at(const ColorVolume& volume, std::ptrdiff_t x, std::ptrdiff_t y,
                       std::ptrdiff_t z) {
  const std::array<std::ptrdiff_t, 3> at{x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (at[axis] < 0 || at[axis] >= static_cast<std::ptrdiff_t>(volume.cells[axis])) return 0;
  }
  const auto width = static_cast<std::ptrdiff_t>(volume.cells[0]);
  const auto height = static_cast<std::ptrdiff_t>(volume.cells[1]);
  return volume.colors[static_cast<std::size_t>(x + width * (y + height * z))];
}

// Along one line of sight, and back along the light from where it ends.
std::array<std::uint8_t, 3> traced(const ColorVolume& volume, std::ptrdiff_t x, std::ptrdiff_t y) {
  auto z = static_cast<std::ptrdiff_t>(volume.cells[2]) - 1;
  while (z >= 0 && color_at(volume, x, y, z) == 0) --z;
  const std::uint32_t color = z < 0 ? 0 : color_at(volume, x, y, z);
  std::uint32_t passed = 0;
  for (std::ptrdiff_t back = 1; z + back < static_cast<std::ptrdiff_t>(volume.cells[2]); ++back) {
    if (color_at(volume, x - back, y + back, z + back) != 0) ++passed;
  }
  return pixel_of(color, std::min(passed, 7U));
}

TEST(Render, IsAsEachLineOfSightAndOfLight) {
  std::mt19937 random(6);
  const std::vector<std::array<std::size_t, 3>> sizes{
      {8, 8, 8}, {1, 1, 1}, {17, 5, 9}, {64, 64, 1}, {3, 40, 30}};
  for (const auto& cells : sizes) {
    for (const unsigned one_in : {2U, 9U, 60U}) {
      const ColorVolume volume = random_volume(cells, one_in, random);
      const std::size_t pixels = 1 + random() % 3;
      const Picture picture = render(volume, pixels);
      ASSERT_EQ(picture.width, cells[0] * pixels);
      ASSERT_EQ(picture.height, cells[1] * pixels);
      for (std::size_t row = 0; row < picture.height; ++row) {
        for (std::size_t column = 0; column < picture.width; ++column) {
          const auto expected = traced(volume, static_cast<std::ptrdiff_t>(column / pixels),
                                       static_cast<std::ptrdiff_t>(cells[1] - 1 - row / pixels));
          for (std::size_t channel = 0; channel < 3; ++channel) {
            ASSERT_EQ(picture.rgb[3 * (row * picture.width + column) + channel], expected[channel]);
          }
        }
      }
    }
  }
}

TEST(Render, ColorsAreToldApartInLightAndInShadow) {
  for (const std::uint32_t shade : {0U, 1U, 7U}) {
    for (std::uint32_t a = 0; a < 8; ++a) {
      for (std::uint32_t b = 0; b < a; ++b) EXPECT_NE(pixel_of(a, shade), pixel_of(b, shade));
      EXPECT_NE(pixel_of(a, 0), pixel_of(a, 1));
    }
  }
}

TEST(Snapshot, IsNamedAsWhatItIs) {
  for (const char* name : {"dish.png", "/dev/stdout"}) EXPECT_EQ(refuse_other_than_png(name), "");
  for (const char* name : {"", "dish", "dish.jpg", "dish.png.jpg", "png"}) {
    EXPECT_NE(refuse_other_than_png(name), "") << name;
  }
}

TEST(Snapshot, ParticlesAreWhiteSpecks) {
  cli::WorldCells cells{{64, 1, 1}, 1, std::string(64, '\0')};
  cells.values[9] = cli::kParticleValue;
  const ColorVolume volume = volume_of(cells);
  EXPECT_EQ(std::count(volume.colors.begin(), volume.colors.end(), 0), 63);
  EXPECT_EQ(volume.colors[9], 7);
}

TEST(Snapshot, EachPieceHasAColorAndNoneIsAFingersWhite) {
  cli::WorldCells cells{{64, 2, 1}, 1, std::string(128, '\0')};
  for (int i = 0; i < 64; ++i) cells.values[static_cast<std::size_t>(i)] = static_cast<char>(i);
  const ColorVolume volume = volume_of(cells);
  EXPECT_EQ(volume.cells, (std::array<std::size_t, 3>{64, 2, 1}));
  ASSERT_EQ(volume.colors.size(), 128U);
  for (std::size_t i = 0; i < 128; ++i) {
    const bool is_matter = i > 0 && i < 64;
    EXPECT_EQ(volume.colors[i] != 0, is_matter) << i;
    EXPECT_LT(volume.colors[i], 7) << i;
    if (!is_matter || i == 1) continue;
    EXPECT_NE(volume.colors[i], volume.colors[i - 1]) << i;
  }
}

TEST(Snapshot, CellsOfASmallWorldAreDrawnLargeAndThoseOfAPlaneFlat) {
  std::mt19937 random(8);
  for (const auto& [sizes, times] :
       {std::pair<std::array<std::uint32_t, 3>, std::uint32_t>{{3, 2, 3}, 21},
        {{32, 16, 1}, 2},
        {{65, 2, 2}, 1}}) {
    cli::WorldCells cells{sizes, 1, std::string(sizes[0] * sizes[1] * sizes[2], '\0')};
    for (auto& value : cells.values) value = static_cast<char>(random() % 3);
    cells.values.back() = 0;  // the front is open
    const ColorVolume volume = volume_of(cells);
    const std::uint32_t deep = sizes[2] == 1 ? 1 : times;
    EXPECT_EQ(volume.cells,
              (std::array<std::size_t, 3>{sizes[0] * times, sizes[1] * times, sizes[2] * deep}));
    constexpr std::array<std::uint8_t, 3> kColors{0, 6, 3};
    for (std::size_t i = 0; i < volume.colors.size(); ++i) {
      const std::size_t x = i % volume.cells[0] / times;
      const std::size_t y = i / volume.cells[0] % volume.cells[1] / times;
      const std::size_t z = i / volume.cells[0] / volume.cells[1] / deep;
      const auto value = static_cast<std::size_t>(cells.values[x + sizes[0] * (y + sizes[1] * z)]);
      ASSERT_EQ(volume.colors[i], kColors.at(value)) << i;
    }
  }
}

TEST(Snapshot, AClosedBoxIsCutInTheMiddle) {
  const std::size_t slice = 64 * 64;
  for (const std::uint32_t deep : {1U, 2U, 7U}) {
    cli::WorldCells box{{64, 64, deep}, 1, std::string(slice * deep, '\1')};
    box.values[70] = 0;
    const bool is_closed = deep > 1;
    const std::size_t kept = is_closed ? (deep + 1) / 2 : 1;
    const ColorVolume volume = volume_of(box);
    ASSERT_EQ(volume.colors.size(), slice * deep);
    for (std::size_t i = 0; i < volume.colors.size(); ++i) {
      ASSERT_EQ(volume.colors[i] != 0, i < kept * slice && i != 70) << i;
    }
    box.values.back() = 0;  // open, if only there
    const auto& open = volume_of(box).colors;
    EXPECT_EQ(std::count(open.begin(), open.end(), 0), 2);
  }
  const cli::WorldCells plane{{64, 64, 1}, 1, std::string(slice, '\1')};
  EXPECT_EQ(volume_of(plane).colors, std::vector<std::uint8_t>(slice, 6)) << "has no middle";
}

TEST(Snapshot, FingersAreWhereTheirHandsAreFelt) {
  api::Status status;
  status.worlds.push_back({.name = "w", .source = "crystal", .cells = {8, 8, 8}, .cell_m = 0.01});
  status.arms.resize(3);
  status.arms[0].world = "w";
  status.arms[0].position_m = {0.015, 0.005, -0.035};
  status.arms[0].offset_m = {0.02, 0, 0};
  status.arms[0].felt.position_m = {0.025, 0.005, -0.035};  // the middle of (6, 4, 0)
  status.arms[1].world = "elsewhere";
  status.arms[2].world = "w";
  status.arms[2].felt.position_m = {std::nan(""), 0, 0};
  ColorVolume volume{{8, 8, 8}, std::vector<std::uint8_t>(512)};
  add_fingers(volume, 1, status.worlds[0], status);
  EXPECT_EQ(std::count(volume.colors.begin(), volume.colors.end(), 7), 1 + 5);
  EXPECT_EQ(volume.colors[6 + 8 * 4], 7);
  EXPECT_EQ(volume.colors[6 + 8 * (4 + 8)], 7);
  status.arms[0].felt.position_m = {1e300, 1e300, 1e300};
  ColorVolume far{{8, 8, 8}, std::vector<std::uint8_t>(512)};
  add_fingers(far, 1, status.worlds[0], status);
  EXPECT_EQ(std::count(far.colors.begin(), far.colors.end(), 7), 0);
  // In a plane the third axis is free.
  ColorVolume plane{{8, 8, 1}, std::vector<std::uint8_t>(64)};
  status.worlds[0].cells = {8, 8, 1};
  status.arms[0].felt.position_m = {0.025, 0.005, 0.4};
  add_fingers(plane, 1, status.worlds[0], status);
  EXPECT_EQ(plane.colors[6 + 8 * 4], 7);
}

TEST(Snapshot, AmongPiecesTheFingerIsWhereTheBoardHasTheGraspPointAndNotWhereTheHandIsNow) {
  api::Status status;
  status.worlds.push_back({.name = "w", .source = "pieces", .cells = {8, 8, 8}, .cell_m = 0.01});
  status.worlds[0].pieces = api::PiecesStatus{.grasp_cell = {6, 4, 0}};
  status.arms.resize(1);
  status.arms[0].world = "w";
  status.arms[0].position_m = {-0.035, -0.035, 0.035};  // it has gone on
  ColorVolume volume{{8, 8, 8}, std::vector<std::uint8_t>(512)};
  add_fingers(volume, 1, status.worlds[0], status);
  EXPECT_EQ(std::count(volume.colors.begin(), volume.colors.end(), 7), 1 + 5);
  EXPECT_EQ(volume.colors[6 + 8 * 4], 7);
  ColorVolume large{{64, 64, 64}, std::vector<std::uint8_t>(64 * 64 * 64)};
  add_fingers(large, 1, status.worlds[0], status);
  EXPECT_EQ(large.colors[52 + 64 * (36 + 64 * 4)], 7) << "the middle of the cell";
  EXPECT_EQ(large.colors[0], 0);
}

TEST(Snapshot, FingersAreWhereTheyAreAmongCellsDrawnLargeAndAmongThinnedOnes) {
  api::Status status;
  status.worlds.push_back({.name = "w", .source = "box", .cells = {4, 4, 4}, .cell_m = 0.01});
  status.arms.resize(1);
  status.arms[0].world = "w";
  status.arms[0].felt.position_m = {0.015, -0.015, 0.0};
  ColorVolume large{{64, 64, 64}, std::vector<std::uint8_t>(64 * 64 * 64)};
  add_fingers(large, 1, status.worlds[0], status);
  EXPECT_EQ(large.colors[56 + 64 * (8 + 64 * 32)], 7);
  EXPECT_EQ(large.colors[56 + 64 * (8 + 64 * 36)], 0);
  // Every third of 190 cells: 64, of which the last stands for one cell beyond.
  status.worlds[0].cells = {190, 190, 190};
  status.arms[0].felt.position_m = {0.01 * (3 * 50 + 1.5 - 95), 0.01 * (3 * 20 + 1.5 - 95),
                                    0.01 * (3 * 10 + 1.5 - 95)};
  ColorVolume thin{{64, 64, 64}, std::vector<std::uint8_t>(64 * 64 * 64)};
  add_fingers(thin, 3, status.worlds[0], status);
  EXPECT_EQ(std::count(thin.colors.begin(), thin.colors.end(), 7), 7);
  EXPECT_EQ(thin.colors[50 + 64 * (20 + 64 * 10)], 7);
}

std::size_t big_endian(const std::string& file, std::size_t at) {
  std::size_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number = number << 8 | static_cast<unsigned char>(file[at + i]);
  return number;
}

TEST(Png, HoldsEveryPixelInChunksThatAreSealed) {
  std::mt19937 random(7);
  Picture picture{31, 7, std::vector<std::uint8_t>(3 * 31 * 7)};
  for (auto& byte : picture.rgb) byte = static_cast<std::uint8_t>(random());
  const std::string file = to_png(picture);
  ASSERT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::string types;
  std::string data;
  for (std::size_t at = 8; at < file.size();) {
    const std::size_t size = big_endian(file, at);
    ASSERT_LE(at + size + 12, file.size());
    const std::string sealed = file.substr(at + 4, size + 4);
    EXPECT_EQ(big_endian(file, at + 8 + size),
              ::crc32(0, reinterpret_cast<const Bytef*>(sealed.data()),
                      static_cast<uInt>(sealed.size())));
    types += sealed.substr(0, 4);
    if (sealed.starts_with("IDAT")) data = sealed.substr(4);
    if (sealed.starts_with("IHDR")) {
      EXPECT_EQ(big_endian(sealed, 4), 31U);
      EXPECT_EQ(big_endian(sealed, 8), 7U);
      EXPECT_EQ(sealed.substr(12), std::string("\x08\x02\x00\x00\x00", 5));
    }
    at += size + 12;
  }
  EXPECT_EQ(types, "IHDRIDATIEND");
  std::string rows(7 * (31 * 3 + 1), 'x');
  uLongf size = rows.size();
  ASSERT_EQ(::uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                         reinterpret_cast<const Bytef*>(data.data()), data.size()),
            Z_OK);
  ASSERT_EQ(size, rows.size());
  for (std::size_t row = 0; row < 7; ++row) {
    EXPECT_EQ(rows[row * 94], '\0');
    for (std::size_t i = 0; i < 93; ++i) {
      ASSERT_EQ(static_cast<std::uint8_t>(rows[row * 94 + 1 + i]), picture.rgb[row * 93 + i]);
    }
  }
}

}  // namespace
}  // namespace thimble::picture
