#include "daemon/world/io/world_source.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "tests/unit/world/npy_bytes.hpp"

namespace thimble::world {
namespace {

TEST(WorldSource, MakesTheBox) {
  const auto sut = make_world("box:64");
  ASSERT_TRUE(sut);
  EXPECT_EQ((*sut)->info().source, "box:64");
  EXPECT_EQ((*sut)->info().cells, (std::array<std::uint32_t, 3>{64, 64, 64}));
  EXPECT_DOUBLE_EQ((*sut)->info().extent_m[0], 0.090);
  EXPECT_TRUE((*sut)->add_probe({}));
}

TEST(WorldSource, ReadsAVolume) {
  const std::string path = ::testing::TempDir() + "thimble-world-source-test.npy";
  std::ofstream(path, std::ios::binary) << NpyBytes{}.file();
  const auto sut = make_world(path, {.workspace_m = 0.04});
  std::remove(path.c_str());
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ((*sut)->info().source, path);
  EXPECT_DOUBLE_EQ((*sut)->info().cell_m, 0.01);
}

TEST(WorldSource, RefusesAVolumeWithoutRoomForAFinger) {
  const std::string path = ::testing::TempDir() + "thimble-world-full-test.npy";
  NpyBytes file;
  file.data = std::string(24, '\1');
  std::ofstream(path, std::ios::binary) << file.file();
  const auto full = make_world(path);
  file.data[23] = '\0';
  std::ofstream(path, std::ios::binary) << file.file();
  const auto with_one_free = make_world(path);
  std::remove(path.c_str());
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, Errc::InvalidArgument);
  EXPECT_EQ(
      full.error().message,
      path + ": threshold: every number of the file is above it: no cell is free for a finger");
  EXPECT_TRUE(with_one_free) << with_one_free.error().message;
}

TEST(WorldSource, SaysWhatItExpected) {
  for (const char* source : {"box:", "box:x", "box:3x", "box:-3", "box: 3", "box:99999999999"}) {
    const auto sut = make_world(source);
    ASSERT_FALSE(sut) << source;
    EXPECT_EQ(sut.error().message, std::string(source) + ": expected box:N with N from 3 to 1024");
  }
  for (const char* source : {"box:0", "box:2", "box:1025"}) {
    EXPECT_NE(make_world(source).error().message.find("not within 3 to 1024"), std::string::npos);
  }
  for (const char* source : {"", "sphere", "volume.mha", "BOX:3"}) {
    EXPECT_EQ(make_world(source).error().code, Errc::InvalidArgument);
    EXPECT_NE(make_world(source).error().message.find(".npy, .nrrd or .nhdr"), std::string::npos);
  }
  EXPECT_EQ(make_world("/none/volume.npy").error().code, Errc::NotFound);
}

TEST(WorldSource, RefusesAWorkspaceThatIsNoLength) {
  for (const double workspace_m : {0.0, -0.09, std::nan(""), HUGE_VAL, 1e-12, 1e9}) {
    EXPECT_FALSE(make_world("box:3", {.workspace_m = workspace_m})) << workspace_m;
  }
}

// The error that both give, or nothing when both are content.
std::optional<Error> agreed_error(const std::string& source, double workspace_m) {
  const auto made = make_world(source, {.workspace_m = workspace_m});
  const auto checked = check_world(source, {.workspace_m = workspace_m});
  EXPECT_EQ(made.has_value(), checked.has_value()) << source << " " << workspace_m;
  if (made || checked) return std::nullopt;
  EXPECT_EQ(made.error(), checked.error());
  return checked.error();
}

TEST(WorldSource, CheckingSaysWhatMakingWouldSay) {
  for (const char* source :
       {"box:3", "box:64", "box:", "box:3x", "box:2", "box:1025", "", "sphere", "box:3.npy",
        "/none/volume.npy", "/none/volume.nrrd", "/none/volume.nhdr", "/dev/zero.npy", "/tmp"}) {
    for (const double workspace_m : {0.09, 0.0, std::nan(""), 1e-12, 1e9}) {
      const bool is_good = workspace_m == 0.09 &&
                           (source == std::string("box:3") || source == std::string("box:64"));
      EXPECT_EQ(agreed_error(source, workspace_m).has_value(), !is_good) << source;
    }
  }
  const std::string path = ::testing::TempDir() + "thimble-world-check-test.npy";
  struct Case {
    const char* shape;
    std::size_t bytes;
    bool is_good;
  };
  for (const auto& [shape, bytes, is_good] :
       {Case{"(2, 3, 4)", 24, true}, Case{"(2, 3, 4)", 23, false}, Case{"(2, 3)", 24, false},
        Case{"(1025, 1, 1)", 1025, false}, Case{"(0, 3, 4)", 0, false}, Case{"x", 24, false}}) {
    NpyBytes file;
    file.shape = shape;
    file.data = std::string(bytes, '\0');
    std::ofstream(path, std::ios::binary) << file.file();
    EXPECT_EQ(agreed_error(path, 0.09).has_value(), !is_good) << shape;
    EXPECT_TRUE(agreed_error(path, 1e-12)) << shape;
  }
  std::remove(path.c_str());
}

}  // namespace
}  // namespace thimble::world
