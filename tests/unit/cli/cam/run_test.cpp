#include "cli/cam/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "cli/cam/board_engine.hpp"
#include "cli/cam/pattern.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::cam {
namespace {

using sim::cam::find_rule;
using sim::cam::SiteSpace;
using testing::HasSubstr;

const Rule& life() { return *find_rule("life"); }

class RunWorldTest : public testing::Test {
 protected:
  Result<RunReport> run(const RunOptions& options) {
    return run_world(*find_rule(options.world), parse_size(options.size).value(), options, clock,
                     {});
  }
  // What was told of a run by a clock that somebody else may hold.
  static std::vector<std::string> told(const RunOptions& options, const Clock& clock) {
    std::vector<std::string> out;
    EXPECT_TRUE(run_world(*find_rule(options.world), parse_size(options.size).value(), options,
                          clock, [&](const std::string& what) { out.push_back(what); }));
    return out;
  }
  sim::VirtualClock clock;
};

TEST(ParseSize, PowersOfTwo) {
  EXPECT_EQ(parse_size("512x512").value(), (SiteSpace{{9, 9, 0}}));
  EXPECT_EQ(parse_size("64x32x16").value(), (SiteSpace{{6, 5, 4}}));
  EXPECT_EQ(parse_size("64").value(), (SiteSpace{{6, 0, 0}}));
  EXPECT_EQ(parse_size("1x1x64").value(), (SiteSpace{{0, 0, 6}}));
  for (const char* const wrong :
       {"", "x", "512x", "x512", "512x512x", "500x512", "0x64", "-64x64", "8x8x8x8", "64 x 64",
        "64X64", "4x4", "99999999999x2", "65536x65536x2"}) {
    const auto size = parse_size(wrong);
    ASSERT_FALSE(size) << wrong;
    EXPECT_EQ(size.error().code, Errc::InvalidArgument);
  }
}

TEST_F(RunWorldTest, EveryEngineComesToTheSame) {
  const RunOptions options{.world = "hpp", .size = "32x32", .steps = 7, .seed = 5};
  std::vector<RunReport> reports;
  for (const char* const engine : {"reference", "general", "compiled", "auto"}) {
    RunOptions of = options;
    of.engine = engine;
    of.modules = 4;
    reports.push_back(run(of).value());
  }
  EXPECT_EQ(reports[0].path, "board");
  EXPECT_EQ(reports[1].path, "table");
  EXPECT_EQ(reports[2].path, "compiled");
  for (const RunReport& report : reports) {
    EXPECT_EQ(report.sites, reports[0].sites);
    EXPECT_EQ(report.population, reports[0].population);
    EXPECT_EQ(report.counters, report.population);
    ASSERT_TRUE(report.board_clocks);
    EXPECT_EQ(report.board_clocks, reports[0].board_clocks);
  }
}

// 60 ms pass between any two looks at it.
class HurriedClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override {
    return now_ = now_ + std::chrono::milliseconds(60);
  }
  Duration sleep_until(MonotonicTime) noexcept override { return {}; }

 private:
  mutable MonotonicTime now_{};
};

TEST_F(RunWorldTest, TellsWhatItDoesBeforeItDoesIt) {
  EXPECT_THAT(
      told({.world = "life", .size = "8x8", .steps = 1}, clock),
      testing::ElementsAre("making the first sites", "step 1 of 1", "counting what came of it",
                           "counting the clocks of a board", "taking the sites out"));
}

TEST_F(RunWorldTest, TellsOfNoMoreStepsThanAnEyeCanFollow) {
  const RunOptions options{.world = "life", .size = "8x8", .steps = 5};
  EXPECT_THAT(told(options, HurriedClock()),
              testing::IsSupersetOf({"step 1 of 5", "step 3 of 5", "step 5 of 5"}));
  EXPECT_EQ(told(options, HurriedClock()).size(), 7U);
  EXPECT_EQ(told(options, clock).size(), 5U) << "all of it took no time";
}

TEST_F(RunWorldTest, OnlyFastEnginesHaveSeveralThreads) {
  RunOptions options{.world = "fhp", .size = "512x256", .steps = 2, .seed = 5, .engine = "general"};
  const auto one = run(options).value();
  options.threads = 3;
  EXPECT_EQ(run(options).value().sites, one.sites);
  options.threads = 0;
  EXPECT_EQ(run(options).error().code, Errc::InvalidArgument);
  options.threads = 2;
  options.engine = "reference";
  EXPECT_EQ(run(options).error().message, "the reference engine has one thread");
}

TEST(LogOfTheBoard, NamesEachRegisterAndItsClock) {
  using cambus::Register;
  EXPECT_EQ(log_of({}), "");
  EXPECT_EQ(
      log_of({{120, Register::Multi}, {7000, Register::FlySrc}}),
      "the simulated board does not model what register 'multi' was set to at clock 120\n"
      "the simulated board does not model what register 'fly-src' was set to at clock 7000\n");
}

TEST_F(RunWorldTest, TheSeedDecides) {
  RunOptions options{.world = "life", .size = "64x64", .steps = 3, .seed = 1};
  const auto first = run(options).value().sites;
  EXPECT_EQ(run(options).value().sites, first);
  options.seed = 2;
  EXPECT_NE(run(options).value().sites, first);
}

// Sweeps of 64 sites: 64 + 40 clocks, a refresh of 4 every third; two modules halve the sweeps.
TEST_F(RunWorldTest, ClocksAreThoseOfItsModules) {
  const auto clocks = [&](int modules, std::uint64_t steps) {
    return run({.world = "life", .size = "64x64", .steps = steps, .modules = modules})
        .value()
        .board_clocks.value();
  };
  const std::uint64_t one = clocks(1, 2) - clocks(1, 1);
  const std::uint64_t two = clocks(2, 2) - clocks(2, 1);
  EXPECT_EQ(one - two, 32 * (64 + 40) + (64 / 3 - 32 / 3) * 4);
  EXPECT_EQ(clocks(1, 0), 0U);
}

// The board that keeps only time against the one that moves everything.
TEST(BoardEngineTest, KeepsTheSameTimeWithoutMovingAnything) {
  const SiteSpace space{{5, 5, 1}};
  const auto whole = BoardEngine::make(space, 4).value();
  const auto time = BoardEngine::make(space, 4, BoardEngine::Keeps::OnlyTime).value();
  for (auto* engine : {whole.get(), time.get()}) {
    ASSERT_TRUE(engine->load(0, sim::cam::table_of(life())));
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(engine->step(life().cycle[0], {}));
  }
  EXPECT_EQ(time->clocks(), whole->clocks());
}

TEST(BoardEngineTest, WhatNoBoardCanDoIsRefused) {
  const SiteSpace space{{4, 4, 0}};
  for (const int modules : {0, -1, 3, 128, 16}) {
    EXPECT_FALSE(BoardEngine::make(space, modules)) << modules;
  }
  const auto board = BoardEngine::make(space, 2).value();
  EXPECT_FALSE(board->step({}, {.written = 1}));
  EXPECT_FALSE(board->step({}, {.bank = 2}));
  const std::vector<sim::cam::PlaneKick> far{{1, {0, 9, 0}}};
  EXPECT_FALSE(board->step(far, {}));
  std::vector<std::uint16_t> few(255);
  EXPECT_FALSE(board->put(few));
  EXPECT_FALSE(board->get(few));
  EXPECT_FALSE(board->load(0, few));
}

class PatternFile : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) {
    const std::string path = testing::TempDir() + "/" + name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
};

TEST_F(PatternFile, LiesInTheMiddle) {
  const std::string file = write("corner.rle", "x = 2, y = 1\n2o!");
  const auto sites = first_sites(life(), {{3, 3, 0}}, {.pattern = file}).value();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_EQ(sites[i], i == 3 * 8 + 3 || i == 3 * 8 + 4 ? 0x1ff : 0) << i;
  }
}

TEST_F(PatternFile, HasTwoCellsASiteAlongBothAxesWhereSitesAreBlocks) {
  const std::string file = write("block.rle", "x = 2, y = 2\nob$bo!");
  const auto sites =
      first_sites(*find_rule("billiard-balls"), {{3, 3, 0}}, {.pattern = file}).value();
  std::vector<std::uint32_t> cells;
  for (const std::uint16_t site : sites) {
    if ((site & 0xf) != 0) cells.push_back(site & 0xfU);
  }
  // Cells (7, 7) and (8, 8) of 16 x 16: the last of a block, and the first of the next one.
  EXPECT_EQ(cells, (std::vector<std::uint32_t>{8, 1}));
}

TEST_F(PatternFile, ThatDoesNotFitIsRefusedByName) {
  const std::string file = write("wide.rle", "x = 9, y = 1\n9o!");
  const auto sites = first_sites(life(), {{3, 3, 0}}, {.pattern = file});
  ASSERT_FALSE(sites);
  EXPECT_THAT(sites.error().message, HasSubstr("wide.rle: the pattern is larger"));
  EXPECT_FALSE(first_sites(life(), {{3, 3, 0}}, {.pattern = write("a.txt", "")}));
  EXPECT_FALSE(first_sites(life(), {{3, 3, 0}}, {.pattern = "/nowhere/a.rle"}));
  EXPECT_FALSE(first_sites(life(), {{3, 3, 0}}, {.pattern = write("a.npy", "no array")}));
}

TEST_F(PatternFile, WhatIsWrittenBeginsTheSameWorld) {
  const SiteSpace space{{4, 3, 1}};
  const auto sites = first_sites(life(), space, {.seed = 9}).value();
  const std::string npy = write("world.npy", to_file(life(), space, sites, "world.npy").value());
  EXPECT_EQ(first_sites(life(), space, {.pattern = npy}).value(), sites);
  EXPECT_FALSE(to_file(life(), space, sites, "world.rle"));
  EXPECT_FALSE(to_file(life(), space, sites, "world.txt"));
  const SiteSpace flat{{4, 3, 0}};
  const auto plane = first_sites(life(), flat, {.seed = 9}).value();
  const std::string text = to_file(life(), flat, plane, "world.rle").value();
  EXPECT_THAT(text, HasSubstr("rule = B3/S23:T16,8\n"));
  EXPECT_EQ(first_sites(life(), flat, {.pattern = write("world.rle", text)}).value(), plane);
}

}  // namespace
}  // namespace thimble::cam
