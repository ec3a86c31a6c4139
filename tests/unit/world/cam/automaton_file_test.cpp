#include "daemon/world/cam/automaton_file.hpp"

#include <gtest/gtest.h>

#include <random>

#include "daemon/world/io/nrrd.hpp"

namespace thimble::world::cam {
namespace {

AutomatonState random_state(std::mt19937& random) {
  AutomatonState state{"life", {}, random(), {}};
  for (int& log2 : state.log2_cells) log2 = static_cast<int>(random() % 5);
  state.sites.resize(std::size_t{1}
                     << (state.log2_cells[0] + state.log2_cells[1] + state.log2_cells[2]));
  for (auto& site : state.sites) site = static_cast<std::uint16_t>(random());
  return state;
}

TEST(AutomatonFile, WhatIsWrittenIsReadAgain) {
  std::mt19937 random(41);
  for (int i = 0; i < 100; ++i) {
    const AutomatonState state = random_state(random);
    const auto again = parse_state(to_nrrd(state));
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(*again, state);
  }
}

TEST(AutomatonFile, IsAVolumeToWhoReadsVolumes) {
  AutomatonState state{"dla", {2, 1, 0}, 5, {0, 0, 7, 0, 0, 0, 0, 300}};
  const std::string file = to_nrrd(state);
  MemorySource source(std::as_bytes(std::span(file)));
  const auto grid = load_nrrd(source, nullptr, {});
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->cells(), (std::array<std::uint32_t, 3>{4, 2, 1}));
  EXPECT_TRUE(grid->is_occupied({2, 0, 0}));
  EXPECT_TRUE(grid->is_occupied({3, 1, 0}));
  EXPECT_EQ(grid->count_occupied(), 2U);
}

TEST(AutomatonFile, EachDamageIsRefusedWithItsKind) {
  const std::string good = to_nrrd({"dla", {2, 1, 0}, 5, std::vector<std::uint16_t>(8)});
  ASSERT_TRUE(parse_state(good));
  const auto code_with = [&](const std::string& what, const std::string& by) {
    std::string file = good;
    const auto at = file.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    file.replace(at, what.size(), by);
    const auto read = parse_state(file);
    EXPECT_FALSE(read) << by;
    return read ? std::optional<Errc>{} : read.error().code;
  };
  EXPECT_EQ(code_with("NRRD0004", "NRRX0004"), Errc::Malformed);
  EXPECT_EQ(code_with("uint16", "int16"), Errc::Unsupported);
  EXPECT_EQ(code_with("little", "big"), Errc::Unsupported);
  EXPECT_EQ(code_with("raw", "gzip"), Errc::Unsupported);
  EXPECT_EQ(code_with("4 2 1", "4 1 1"), Errc::Malformed);
  EXPECT_EQ(code_with("4 2 1", "8 1 1\nbyte skip: -1"), Errc::Unsupported);
  EXPECT_EQ(code_with("4 2 1", "3 2 1"), Errc::Malformed);
  EXPECT_EQ(code_with("thimble_rule", "thimble_role"), Errc::Unsupported);
  EXPECT_EQ(code_with(":=dla", ":=d/a"), Errc::Malformed);
  EXPECT_EQ(code_with(":=5", ":=5x"), Errc::Malformed);
  EXPECT_EQ(code_with(":=5", ":=-5"), Errc::Malformed);
  EXPECT_EQ(parse_state(good + "x").error().code, Errc::Malformed);
  EXPECT_EQ(parse_state(std::string_view(good).substr(0, good.size() - 1)).error().code,
            Errc::Malformed);
  EXPECT_EQ(parse_state("").error().code, Errc::Malformed);
  EXPECT_EQ(parse_state(std::string(kMaxStateBytes + 1, 'x')).error().code, Errc::TooLarge);
}

}  // namespace
}  // namespace thimble::world::cam
