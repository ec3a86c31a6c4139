#include "daemon/session/rule_automaton.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <utility>
#include <vector>

#include "daemon/session/live_settings.hpp"
#include "daemon/world/cam/live_world.hpp"
#include "daemon/world/near_cell_finder.hpp"

namespace thimble::session {
namespace {

using Bits = std::vector<std::uint64_t>;
using world::cam::AutomatonState;
using world::cam::LiveWorld;

std::unique_ptr<world::cam::Automaton> automaton(const char* rule, const CamAxes& log2,
                                                 std::uint64_t seed) {
  return make_rule_automaton(*sim::cam::find_rule(rule), log2, {.seed = seed}).value();
}

bool at(const Bits& bits, std::size_t x, std::size_t y, std::size_t log2_x, std::size_t log2_y) {
  x &= (std::size_t{1} << log2_x) - 1;
  y &= (std::size_t{1} << log2_y) - 1;
  const std::size_t cell = y << log2_x | x;
  return (bits[cell / 64] >> (cell % 64) & 1) != 0;
}

// B3/S23 on a torus, written from the rule's own words.
Bits life_after(const Bits& before, std::size_t log2_x, std::size_t log2_y) {
  Bits after(before.size());
  for (std::size_t y = 0; y < std::size_t{1} << log2_y; ++y) {
    for (std::size_t x = 0; x < std::size_t{1} << log2_x; ++x) {
      int neighbors = 0;
      for (const int dy : {-1, 0, 1}) {
        for (const int dx : {-1, 0, 1}) {
          if (dx == 0 && dy == 0) continue;
          neighbors += at(before, x + static_cast<std::size_t>(dx),
                          y + static_cast<std::size_t>(dy), log2_x, log2_y)
                           ? 1
                           : 0;
        }
      }
      const bool lives = neighbors == 3 || (neighbors == 2 && at(before, x, y, log2_x, log2_y));
      const std::size_t cell = y << log2_x | x;
      after[cell / 64] |= std::uint64_t{lives ? 1U : 0U} << (cell % 64);
    }
  }
  return after;
}

TEST(RuleAutomaton, LifeIsLifeWhateverIsWrittenBetweenItsSteps) {
  std::mt19937_64 random(31);
  for (const auto& [log2_x, log2_y] : {std::pair{5, 5}, std::pair{7, 4}}) {
    const auto sut = automaton("life", {log2_x, log2_y, 0}, 7);
    Bits matter((std::size_t{1} << (log2_x + log2_y)) / 64);
    sut->read(matter);
    EXPECT_NE(matter, Bits(matter.size())) << "it lives at first";
    for (int step = 0; step < 60; ++step) {
      Bits expected = matter;
      if (step % 7 == 3) {
        Bits changed(matter.size());
        Bits wanted(matter.size());
        for (std::size_t i = 0; i < matter.size(); ++i) {
          changed[i] = random() & random() & random();
          wanted[i] = random();
          expected[i] = (matter[i] & ~changed[i]) | (wanted[i] & changed[i]);
        }
        sut->write(changed, wanted);
        sut->read(matter);
        ASSERT_EQ(matter, expected);
      }
      sut->step();
      sut->read(matter);
      ASSERT_EQ(matter, life_after(expected, static_cast<std::size_t>(log2_x),
                                   static_cast<std::size_t>(log2_y)))
          << step;
    }
    EXPECT_EQ(sut->steps(), 60U);
  }
}

// Gas and crystal together, one for each bit.
std::uint64_t particles(const AutomatonState& state, std::uint16_t gas, std::uint16_t crystal) {
  std::uint64_t sum = 0;
  for (const std::uint16_t site : state.sites) {
    sum += static_cast<std::uint64_t>(std::popcount(site & std::uint32_t{gas}));
    sum += (site & crystal) != 0 ? 1U : 0U;
  }
  return sum;
}

std::uint64_t count(const Bits& bits) {
  std::uint64_t sum = 0;
  for (const std::uint64_t word : bits) sum += static_cast<std::uint64_t>(std::popcount(word));
  return sum;
}

TEST(RuleAutomaton, ACrystalOnlyGrowsAndParticlesAreLostOnlyToPokes) {
  struct Case {
    const char* rule;
    CamAxes log2;
    std::uint16_t gas;
    std::uint16_t crystal;
  };
  for (const Case& of :
       {Case{"dla", {6, 6, 0}, 0xf, 0x10}, Case{"dla-3d", {4, 4, 4}, 0x3f, 0x40}}) {
    SCOPED_TRACE(of.rule);
    const auto sut = automaton(of.rule, of.log2, 5);
    Bits before((std::size_t{1} << (of.log2[0] + of.log2[1] + of.log2[2])) / 64);
    sut->read(before);
    EXPECT_EQ(count(before), 1U);
    std::uint64_t all = particles(sut->save(), of.gas, of.crystal);
    std::uint64_t poked = 0;
    Bits now(before.size());
    for (int step = 0; step < 400; ++step) {
      if (step % 100 == 60) {  // a hole through the middle
        Bits changed(before.size());
        for (std::size_t i = changed.size() / 2; i < changed.size() / 2 + 4; ++i) {
          changed[i] = 0x0ff00ff00ff00ff0;
          poked += static_cast<std::uint64_t>(std::popcount(before[i] & changed[i]));
          before[i] &= ~changed[i];
        }
        sut->write(changed, Bits(before.size()));
      }
      sut->step();
      sut->read(now);
      for (std::size_t i = 0; i < now.size(); ++i) ASSERT_EQ(before[i] & ~now[i], 0U) << step;
      before = now;
      ASSERT_EQ(particles(sut->save(), of.gas, of.crystal) + poked, all) << step;
    }
    EXPECT_GT(poked, 10U);
    EXPECT_GT(count(now), 30U);
  }
}

TEST(RuleAutomaton, ASavedStateGoesOnAsItselfAndOnlyThere) {
  for (const char* rule : {"life", "dla", "critters"}) {
    SCOPED_TRACE(rule);
    const auto sut = automaton(rule, {5, 5, 0}, 3);
    for (int i = 0; i < 7; ++i) sut->step();
    const AutomatonState middle = sut->save();
    EXPECT_EQ(middle.steps, 7U);
    for (int i = 0; i < 9; ++i) sut->step();
    const auto other = automaton(rule, {5, 5, 0}, 4);
    ASSERT_TRUE(other->load(middle));
    for (int i = 0; i < 9; ++i) other->step();
    EXPECT_EQ(other->save(), sut->save());
    AutomatonState strange = middle;
    strange.rule = "hpp";
    EXPECT_EQ(other->load(strange).error().code, Errc::InvalidArgument);
    strange = middle;
    strange.log2_cells = {6, 4, 0};
    EXPECT_EQ(other->load(strange).error().code, Errc::InvalidArgument);
    strange = middle;
    strange.sites.pop_back();
    EXPECT_EQ(other->load(strange).error().code, Errc::InvalidArgument);
    EXPECT_EQ(other->save(), sut->save()) << "nothing was changed";
  }
}

TEST(LiveWorldOfAConfiguration, IsTheRuleAndSizeThatItSays) {
  config::WorldConfig said;
  said.source = "life";
  said.automaton = config::AutomatonConfig{.cells = 64};
  const auto life = make_live_world(said);
  ASSERT_TRUE(life) << life.error().message;
  EXPECT_EQ((*life)->info().cells, (std::array<std::uint32_t, 3>{64, 64, 1}));
  EXPECT_EQ((*life)->info().extent_m[2], 0);
  EXPECT_GT((*life)->occupied_cells(), 1000U);
  EXPECT_EQ((*life)->live()->save().rule, "life");
  said.automaton->fill_fraction = 0;
  EXPECT_EQ(make_live_world(said).value()->occupied_cells(), 0U);
  said.source = "crystal";
  said.automaton = config::AutomatonConfig{.cells = 32};
  EXPECT_EQ(make_live_world(said).value()->live()->save().rule, "dla");
  said.automaton->axes = 3;
  const auto crystal = make_live_world(said);
  ASSERT_TRUE(crystal);
  EXPECT_EQ((*crystal)->live()->save().rule, "dla-3d");
  EXPECT_EQ((*crystal)->info().cells, (std::array<std::uint32_t, 3>{32, 32, 32}));
  EXPECT_DOUBLE_EQ((*crystal)->info().extent_m[2], 0.09);
}

// Within `cells` along each axis, on the torus.
Bits zone_of(const Bits& matter, const CamAxes& log2, int cells) {
  Bits zone(matter.size());
  const auto reach = [&](int axis) { return log2[static_cast<std::size_t>(axis)] > 0 ? cells : 0; };
  for (std::size_t cell = 0; cell < matter.size() * 64; ++cell) {
    if ((matter[cell / 64] >> (cell % 64) & 1) == 0) continue;
    for (int dz = -reach(2); dz <= reach(2); ++dz) {
      for (int dy = -reach(1); dy <= reach(1); ++dy) {
        for (int dx = -reach(0); dx <= reach(0); ++dx) {
          const auto on = [&](std::size_t axis, std::size_t at, int by) {
            return (at + static_cast<std::size_t>(by)) & ((std::size_t{1} << log2[axis]) - 1);
          };
          const std::size_t x = on(0, cell, dx);
          const std::size_t y = on(1, cell >> log2[0], dy);
          const std::size_t z = on(2, cell >> (log2[0] + log2[1]), dz);
          const std::size_t near = x | y << log2[0] | z << (log2[0] + log2[1]);
          zone[near / 64] |= std::uint64_t{1} << (near % 64);
        }
      }
    }
  }
  return zone;
}

TEST(RuleAutomaton, MarksTheZoneAroundItsMatterByAProgramOfItsOwn) {
  const std::vector<std::pair<const char*, CamAxes>> worlds{
      {"life", {6, 5, 0}}, {"dla", {5, 5, 0}}, {"dla-3d", {5, 4, 4}}};
  for (const auto& [rule, log2] : worlds) {
    const auto sut = automaton(rule, log2, 17);
    Bits matter((std::size_t{1} << (log2[0] + log2[1] + log2[2])) / 64);
    for (int step = 0; step < 40; ++step) sut->step();
    for (const int cells : {1, 2, 3, 4, 5, 9, 14, 31}) {
      Bits sparse(matter.size());
      sparse[sparse.size() / 2] = 0x8001;
      sut->write(Bits(matter.size(), ~std::uint64_t{0}), sparse);
      const AutomatonState before = sut->save();
      Bits zone(matter.size(), 0x5555);
      ASSERT_TRUE(sut->mark_zone(cells, zone));
      EXPECT_EQ(zone, zone_of(sparse, log2, cells)) << rule << ", " << cells;
      EXPECT_EQ(sut->save(), before) << "what is marked changes nothing";
    }
    sut->step();
    sut->read(matter);
    Bits zone(matter.size());
    ASSERT_TRUE(sut->mark_zone(2, zone));
    EXPECT_EQ(zone, zone_of(matter, log2, 2)) << rule;
  }
}

// What a hand is told does not depend on who looked for it.
TEST(RuleAutomaton, OutsideItsZoneNothingIsNear) {
  for (const int axes : {2, 3}) {
    config::WorldConfig said;
    said.source = axes == 2 ? "life" : "crystal";
    said.automaton = config::AutomatonConfig{};
    said.automaton->axes = axes;
    said.automaton->cells = 32;
    said.automaton->fill_fraction = 0.02;
    const auto world = make_live_world(said);
    ASSERT_TRUE(world) << world.error().message;
    world::cam::LiveWorld& sut = *(*world)->live();
    const world::VoxelGrid& grid = *sut.felt_cells();
    const double reach_m = 2.5 * grid.cell_m();
    sut.mark_zone(world::zone_cells(reach_m, grid.cell_m()));
    world::NearCellFinder finder;
    std::mt19937 random(18);
    int outside = 0;
    for (int run = 0; run < 4000; ++run) {
      if (run % 200 == 0) {
        (void)sut.pump({});
        (void)sut.pump({std::chrono::seconds(run)});
      }
      world::NearQuery query{.reach_m = reach_m, .is_plane = sut.is_plane()};
      for (std::size_t axis = 0; axis < (sut.is_plane() ? 2U : 3U); ++axis) {
        query.middle[axis] = static_cast<std::int32_t>(random() % 32);
        query.ghost[axis] = grid.face_m(axis, query.middle[axis] + static_cast<int>(random() % 2));
      }
      query.hand = query.ghost;
      if (sut.is_in_zone(query.middle)) continue;
      ++outside;
      EXPECT_TRUE(finder.find(grid, query).boxes.empty()) << run;
    }
    EXPECT_GT(outside, 300) << axes;
  }
}

}  // namespace
}  // namespace thimble::session
