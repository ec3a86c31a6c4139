#include "daemon/world/io/field_file.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "tests/unit/world/npy_bytes.hpp"

namespace thimble::world {
namespace {

// [2, 3, 4] of little-endian floats; number i of the file is 1 + i.
NpyBytes counted() {
  NpyBytes bytes;
  bytes.descr = "'<f4'";
  bytes.data.clear();
  for (int i = 0; i < 24; ++i) {
    const auto word = std::bit_cast<std::uint32_t>(static_cast<float>(1 + i));
    for (int byte = 0; byte < 4; ++byte) bytes.data += static_cast<char>(word >> (8 * byte));
  }
  return bytes;
}

Result<DistanceField> load_bytes(const std::string& file, const FieldOptions& options) {
  MemorySource source(bytes_of(file));
  return load_npy_field(source, options);
}

// What lies at node (x, y, z) of a field of so many nodes.
double at_node(const DistanceField& field, double x, double y, double z) {
  const auto& [nx, ny, nz] = field.numbers();
  const double step_m = field.step_m();
  return field
      .look({(x - (nx - 1) / 2.0) * step_m, (y - (ny - 1) / 2.0) * step_m,
             (z - (nz - 1) / 2.0) * step_m})
      .distance_m;
}

TEST(FieldFile, NumbersAreDistancesAtTheMiddlesOfCells) {
  const auto sut = load_bytes(counted().file(), {.volume = {.workspace_m = 0.08}, .unit_m = 0.001});
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->numbers(), (std::array<std::uint32_t, 3>{2, 3, 4}));
  EXPECT_DOUBLE_EQ(sut->step_m(), 0.02) << "the longest axis spans the workspace";
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 4; ++z) {
        EXPECT_NEAR(at_node(*sut, x, y, z), 0.001 * (1 + z + 4 * (y + 3 * x)), 1e-8);
      }
    }
  }
}

TEST(FieldFile, OrdersOfTheFileAndOfTheConfigurationAreKept) {
  NpyBytes bytes = counted();
  bytes.fortran_order = "True";
  FieldOptions options{.volume = {.cell_m = 0.01}};
  options.volume.axis_order = {2, 0, 1};
  options.volume.is_reversed = {false, true, false};
  const auto sut = load_bytes(bytes.file(), options);
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->numbers(), (std::array<std::uint32_t, 3>{3, 4, 2}));
  EXPECT_DOUBLE_EQ(sut->step_m(), 0.01);
  // Axis 0 of the file is z, axis 1 is x and runs the other way, axis 2 is y.
  EXPECT_NEAR(at_node(*sut, 2 - 1, 3, 1), 1 + 1 + 2 * (1 + 3 * 3), 1e-5);
}

TEST(FieldFile, WhatIsNoDistanceIsRefused) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf(""), 1e30F}) {
    NpyBytes bytes = counted();
    const auto word = std::bit_cast<std::uint32_t>(bad);
    for (int byte = 0; byte < 4; ++byte)
      bytes.data[40U + static_cast<unsigned>(byte)] = static_cast<char>(word >> (8 * byte));
    const auto sut = load_bytes(bytes.file(), {});
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().code, Errc::Malformed) << sut.error().message;
  }
  NpyBytes flat = counted();
  flat.shape = "(1, 6, 4)";
  EXPECT_EQ(load_bytes(flat.file(), {}).error().code, Errc::InvalidArgument);
  EXPECT_EQ(load_bytes(counted().file(), {.volume = {.spacing = {{1, 1, 2}}}}).error().code,
            Errc::Unsupported);
  const std::string whole = counted().file();
  EXPECT_FALSE(load_bytes(whole.substr(0, whole.size() - 1), {}));
}

TEST(FieldFile, ReadsNrrdAndSaysTheSameWithoutReadingIt) {
  const std::string path = ::testing::TempDir() + "thimble-field.nrrd";
  {
    std::ofstream file(path);
    file << "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: text\n\n"
         << "-0.5 1 2 3 4 5 6 7\n";
  }
  const auto sut = load_field_file(path, {.volume = {.cell_m = 0.01}, .unit_m = 0.01});
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_NEAR(at_node(*sut, 0, 0, 0), -0.005, 1e-8);
  EXPECT_NEAR(at_node(*sut, 1, 0, 0), 0.01, 1e-8) << "the first axis runs fastest";
  EXPECT_TRUE(check_field_file(path, {}));
  const auto anisotropic = check_field_file(path, {.volume = {.spacing = {{1, 1, 2}}}});
  ASSERT_FALSE(anisotropic);
  EXPECT_TRUE(anisotropic.error().message.starts_with(path)) << anisotropic.error().message;
  EXPECT_EQ(load_field_file(path + "?", {}).error().code, Errc::NotFound);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace thimble::world
