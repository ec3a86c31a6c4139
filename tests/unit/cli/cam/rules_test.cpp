#include "sim/model/cam/rules/rule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>

#include "cli/cam/board_engine.hpp"
#include "cli/cam/run.hpp"
#include "sim/model/cam/engine/plane_engine.hpp"

// Each rule by what is known of it, and all of them alike on every engine.
namespace thimble::cam {
namespace {

using sim::cam::find_rule;
using sim::cam::LayerBits;
using sim::cam::PlaneCounts;
using sim::cam::PlaneEngine;
using sim::cam::rules;
using sim::cam::SiteSpace;
using sim::cam::table_of;
using sim::cam::TablePath;
using Sites = std::vector<std::uint16_t>;

constexpr SiteSpace kFlat{{6, 6, 0}};
constexpr SiteSpace kDeep{{5, 5, 5}};

// A world that goes on; its engine is compiled, or the board.
struct World {
  const Rule& rule;
  std::unique_ptr<sim::cam::Engine> engine;
  std::size_t steps_taken{0};

  void run(std::size_t steps) {
    for (std::size_t i = 0; i < steps; ++i, ++steps_taken) {
      ASSERT_TRUE(engine->step(rule.cycle[steps_taken % rule.cycle.size()], {}));
    }
  }
  Sites sites() {
    Sites all(engine->space().sites());
    EXPECT_TRUE(engine->get(all));
    return all;
  }
  std::uint64_t count(LayerBits layers) {
    const PlaneCounts population = engine->population();
    std::uint64_t sum = 0;
    for (std::size_t layer = 0; layer < 16; ++layer) {
      if ((layers >> layer & 1) != 0) sum += population[layer];
    }
    return sum;
  }
};

World begin(std::unique_ptr<sim::cam::Engine> engine, const Rule& rule, const Sites& sites) {
  EXPECT_TRUE(engine->load(0, table_of(rule)));
  EXPECT_TRUE(engine->put(sites));
  return {rule, std::move(engine)};
}

World begin(std::string_view name, const SiteSpace& space) {
  const Rule& rule = *find_rule(name);
  return begin(PlaneEngine::make(space, TablePath::Auto).value(), rule,
               first_sites(rule, space, {.seed = 81}).value());
}

std::uint16_t at(const Sites& sites, const SiteSpace& space, std::size_t x, std::size_t y,
                 std::size_t z = 0) {
  const auto wrap = [&](std::size_t value, std::size_t axis) {
    return value & ((std::size_t{1} << space.log2_cells[axis]) - 1);
  };
  return sites[(wrap(z, 2) << space.log2_cells[1] | wrap(y, 1)) << space.log2_cells[0] |
               wrap(x, 0)];
}

class EachRule : public testing::TestWithParam<std::string> {};
std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Rule& rule : rules()) all.emplace_back(rule.name);
  return all;
}
std::string test_name(const testing::TestParamInfo<std::string>& rule) {
  std::string name = rule.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Rules, EachRule, testing::ValuesIn(names()), test_name);

TEST_P(EachRule, IsTheSameOnEveryEngine) {
  const Rule& rule = *find_rule(GetParam());
  const SiteSpace space{{4, 4, 3}};
  const Sites sites = first_sites(rule, space, {.seed = 82}).value();
  std::array<World, 4> worlds{
      begin(PlaneEngine::make(space, TablePath::General).value(), rule, sites),
      begin(PlaneEngine::make(space, TablePath::Compiled).value(), rule, sites),
      begin(BoardEngine::make(space, 1).value(), rule, sites),
      begin(BoardEngine::make(space, 2).value(), rule, sites)};
  for (int i = 0; i < 3; ++i) {
    for (World& world : worlds) world.run(1);
    const Sites expected = worlds[2].sites();
    EXPECT_NE(expected, sites);
    for (World& world : worlds) ASSERT_EQ(world.sites(), expected) << i;
  }
}

// As few as the slowest instruction set can make good use of, but for one that only the fastest
// can: which of six particles stays depends on all of them.
TEST_P(EachRule, CompilesToFewerOperationsThanAreWorthIt) {
  const bool is_large = GetParam() == "dla-3d";
  const auto& kernels = sim::cam::built_kernels();
  const std::size_t worth_ops = (is_large ? kernels.front() : kernels.back())->worth_ops;
  EXPECT_TRUE(sim::cam::compile_rule(table_of(*find_rule(GetParam())), worth_ops));
}

TEST(CamRules, AreNamedOnceInOrder) {
  const auto all = rules();
  EXPECT_EQ(all.size(), 16U);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LT(all[i - 1].name, all[i].name);
  EXPECT_EQ(find_rule("no such"), nullptr);
}

TEST(CamRules, MatterIsKept) {
  for (const char* const name : {"hpp", "fhp", "gas-3d", "billiard-balls", "tm-gas", "diffusion"}) {
    World world = begin(name, std::string_view(name) == "gas-3d" ? kDeep : kFlat);
    const Sites start = world.sites();
    const std::uint64_t matter = world.count(world.rule.matter);
    EXPECT_GT(matter, 0U);
    world.run(50);
    EXPECT_EQ(world.count(world.rule.matter), matter) << name;
    EXPECT_NE(world.sites(), start) << name;
  }
}

TEST(CamRules, CrittersAreAsManyAsWereMissingAStepBefore) {
  World world = begin("critters", kFlat);
  const std::uint64_t before = world.count(0xf);
  world.run(1);
  EXPECT_EQ(world.count(0xf), 4 * kFlat.sites() - before);
  world.run(1);
  EXPECT_EQ(world.count(0xf), before);
}

TEST(CamRules, ParityDiesOutOnATorusOfAPowerOfTwo) {
  for (const SiteSpace& space : {SiteSpace{{5, 5, 5}}, SiteSpace{{5, 5, 0}}}) {
    World world = begin("parity", space);
    world.run(15);
    EXPECT_GT(world.count(1), 0U);
    world.run(1);
    EXPECT_EQ(world.count(0xffff), 0U);
  }
}

TEST(CamRules, LifeHasABlinkerOfTwoSteps) {
  World world = begin("life", kFlat);
  Sites sites(kFlat.sites());
  for (std::size_t x = 30; x < 33; ++x) sites[30 * 64 + x] = world.rule.matter;
  ASSERT_TRUE(world.engine->put(sites));
  world.run(1);
  const Sites upright = world.sites();
  for (std::size_t y = 29; y < 32; ++y) EXPECT_EQ(at(upright, kFlat, 31, y), 0x1ff);
  EXPECT_EQ(world.count(1), 3U);
  world.run(1);
  EXPECT_EQ(world.sites(), sites);
}

// The complement of a majority is the majority of the complement.
TEST(CamRules, TwistedMajorityCommutesWithTheComplement) {
  World world = begin("twisted-majority", kFlat);
  World other = begin("twisted-majority", kFlat);
  const auto complement = [](Sites sites) {
    for (auto& site : sites) site = static_cast<std::uint16_t>(site ^ 0x1ff);
    return sites;
  };
  ASSERT_TRUE(other.engine->put(complement(world.sites())));
  world.run(10);
  other.run(10);
  EXPECT_EQ(other.sites(), complement(world.sites()));
}

TEST(CamRules, TheTimeTunnelRunsBackWhenNowAndThePastAreSwapped) {
  World world = begin("time-tunnel", kFlat);
  const Sites start = world.sites();
  const auto swapped = [](Sites sites) {
    for (auto& site : sites) {
      site = static_cast<std::uint16_t>((site >> 1 & 1) * 0x3d | (site & 1) << 1);
    }
    return sites;
  };
  world.run(30);
  EXPECT_NE(world.sites(), start);
  ASSERT_TRUE(world.engine->put(swapped(world.sites())));
  world.run(30);
  EXPECT_EQ(swapped(world.sites()), start);
}

// Pairs of unequal neighbours, and twice what the demons have.
std::uint64_t energy(const Sites& sites) {
  std::uint64_t sum = 0;
  for (std::size_t y = 0; y < 64; ++y) {
    for (std::size_t x = 0; x < 64; ++x) {
      const std::uint16_t site = at(sites, kFlat, x, y);
      sum += (site ^ at(sites, kFlat, x + 1, y)) & 1U;
      sum += (site ^ at(sites, kFlat, x, y + 1)) & 1U;
      sum += 2 * (site >> 6 & 3U);
    }
  }
  return sum;
}

TEST(CamRules, SpinsKeepTheirEnergy) {
  for (const char* const name : {"q2r", "ising-demon"}) {
    World world = begin(name, kFlat);
    const Sites start = world.sites();
    for (int i = 0; i < 10; ++i) {
      world.run(5);
      ASSERT_EQ(energy(world.sites()), energy(start)) << name << " " << i;
    }
    EXPECT_NE(world.sites(), start);
  }
}

TEST(CamRules, ACrystalGrowsByWhatTheGasLoses) {
  for (const auto& [name, space] : {std::pair{"dla", kFlat}, std::pair{"dla-3d", kDeep}}) {
    SCOPED_TRACE(name);
    World world = begin(name, space);
    const auto lowest = static_cast<LayerBits>(world.rule.crystal & -world.rule.crystal);
    const auto all = static_cast<LayerBits>(world.rule.matter | lowest);
    const std::uint64_t matter = world.count(all);
    std::uint64_t crystal = world.count(lowest);
    EXPECT_EQ(crystal, 1U);
    for (int i = 0; i < 20; ++i) {
      world.run(20);
      EXPECT_EQ(world.count(all), matter);
      EXPECT_GE(world.count(lowest), crystal);
      crystal = world.count(lowest);
    }
    EXPECT_GT(crystal, 20U);
  }
}

// As often set as not, on the average, and by its own law the complement as likely.
TEST(CamRules, AnnealingMakesRegionsOutOfNoise) {
  World world = begin("annealing", kDeep);
  const auto unequal = [](const Sites& sites) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      sum += (sites[i] ^ at(sites, kDeep, i % 32 + 1, i / 32 % 32, i / 1024)) & 1U;
    }
    return sum;
  };
  const std::uint64_t before = unequal(world.sites());
  world.run(30);
  EXPECT_LT(unequal(world.sites()), before / 2);
  const Rule& rule = world.rule;
  for (std::uint32_t site = 0; site < 0x800; ++site) {
    // Random bits at their opposite stand for the opposite chance.
    const std::uint32_t opposite = (site ^ 0x7f) ^ 0x180;
    EXPECT_NE(rule.function(site) & 1, rule.function(opposite) & 1) << site;
  }
}

}  // namespace
}  // namespace thimble::cam
