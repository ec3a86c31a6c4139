// What our own scheme does where the map does not help: cells that change, silence, maps that lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "composed.hpp"
#include "fake_box.hpp"
#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using testing::Composed;
using testing::delayed_by;
using testing::in_cells_of;
using testing::kTick;
using world::Cell;
using world::VoxelGrid;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kCell_m = 0.010;
constexpr double kInside_m = 0.0005;

VoxelGrid room() { return VoxelGrid::create({21, 9, 9}, kCell_m).value(); }

void fill_from(Composed& sut, std::int32_t x, bool is_occupied) {
  for (Cell c{x, 0, 0}; c.z < 9; ++c.z) {
    for (c.y = 0; c.y < 9; ++c.y) {
      for (c.x = x; c.x < 21; ++c.x) sut.cells.set_cell(c, is_occupied);
    }
  }
}

TEST(Composite, AWallThatAppearsBeforeTheHandIsFeltWhereItIsOnceItIsToldOf) {
  for (const double delay_s : {0.005, 0.02, 0.1, 0.5}) {
    Composed sut(room(), kTick, delayed_by(delay_s));
    (void)sut.rest({-0.05, 0, 0}, delay_s + 0.2);
    fill_from(sut, 13, true);
    const double face_m = sut.cells.grid()->face_m(0, 13);
    (void)sut.rest({-0.05, 0, 0}, delay_s + 0.01);
    double x_m = -0.05;
    ArmOutput out;
    while (out.force.x == 0 && x_m < 0.1) out = sut.loop.tick({x_m += 0.0002, 0, 0}, {0.2, 0, 0});
    EXPECT_NEAR(x_m, face_m, 0.0003) << delay_s;
    EXPECT_EQ(out.offset, Displacement3{});
  }
}

// The hand is already past it: the frame gives way, and the finger is just inside the wall.
TEST(Composite, AWallThatAppearsBehindTheHandIsFeltLateByOffsetAndWithoutAKick) {
  for (const double delay_s : {0.02, 0.1, 0.3, 0.4, 0.5}) {
    Composed sut(room(), kTick, delayed_by(delay_s));
    double x_m = -0.03;
    (void)sut.rest({x_m, 0, 0}, delay_s + 0.2);
    const double face_m = sut.cells.grid()->face_m(0, 10);
    fill_from(sut, 10, true);
    ArmOutput out;
    double before_newton = 0;
    double past_m = 0;
    for (int i = 0; i < 400; ++i) {
      out = sut.loop.tick({x_m += 0.0002, 0, 0}, {0.2, 0, 0});
      // K·H, a tick's way, and the damper: a contact that starts at full speed.
      EXPECT_LT(std::abs(out.force.x) - before_newton, 800 * (kInside_m + 0.0002) + 5 * 0.2)
          << delay_s;
      before_newton = std::abs(out.force.x);
      if (out.force.x < 0) break;
      past_m = std::max(0.0, x_m - face_m);
    }
    ASSERT_LT(out.force.x, 0) << delay_s;
    // The news waits for no question: half of D late, in which the hand comes to the face first.
    const double expected_m = std::max(0.0, 0.2 * delay_s / 2 - 0.025);
    EXPECT_NEAR(past_m, expected_m, 0.0006) << delay_s;
    if (past_m > kInside_m) {
      EXPECT_LT(out.offset.x, 0) << delay_s;
    }
    EXPECT_LE(x_m + out.offset.x - face_m, kInside_m + 0.0003);
  }
}

TEST(Composite, AWallThatGoesIsFeltUntilThatIsToldAndNoLonger) {
  Composed sut(room(), kTick, delayed_by(0.1));
  fill_from(sut, 13, true);
  const double x_m = sut.cells.grid()->face_m(0, 13) + 0.003;
  (void)sut.rest({0, 0, 0}, 0.4);
  for (int i = 0; i < 100; ++i) (void)sut.loop.tick({x_m * i / 100, 0, 0}, {});
  ArmOutput out = sut.rest({x_m, 0, 0}, 0.3);
  const double pressed_newton = -out.force.x;
  EXPECT_GT(pressed_newton, 2);
  fill_from(sut, 13, false);
  int felt = 0;
  while (out.force.x < 0 && felt < 1000) {
    out = sut.loop.tick({x_m, 0, 0}, {});
    ++felt;
  }
  EXPECT_NEAR(felt, 51, 2) << "half the round trip: the news comes by itself";
  out = sut.rest({x_m, 0, 0}, 0.3);
  EXPECT_EQ(out.force, Force3{});
  EXPECT_EQ(out.sample.ghost, out.sample.hand);
}

TEST(Composite, MatterThatFillsTheHandPushesItOutGently) {
  Composed sut(room(), kTick, delayed_by(0.05));
  (void)sut.rest({0.001, 0, 0}, 0.4);
  sut.cells.set_cell({10, 4, 4}, true);
  double hardest_newton = 0;
  double last_newton = 0;
  for (int i = 0; i < 500; ++i) {
    const double newton = norm(sut.loop.tick({0.001, 0, 0}, {}).force);
    EXPECT_LT(newton - last_newton, 0.5);
    hardest_newton = std::max(hardest_newton, newton);
    last_newton = newton;
  }
  EXPECT_GT(hardest_newton, 0.3);
  EXPECT_LE(hardest_newton, 800 * 0.004 + 0.1);
}

TEST(Composite, OfASilentWorldTheMapIsFeltThenFadesAndComesBackGently) {
  Composed sut(room(), kTick, delayed_by(0.02));
  fill_from(sut, 13, true);
  const double face_m = sut.cells.grid()->face_m(0, 13);
  (void)sut.rest({0, 0, 0}, 0.4);
  sut.loop.is_up = false;
  double x_m = 0;
  ArmOutput out;
  while (x_m < face_m + 0.002) out = sut.loop.tick({x_m += 0.0002, 0, 0}, {});
  EXPECT_LT(out.force.x, -1.5) << "a wall that is known is there";
  EXPECT_TRUE(out.is_frozen);
  double last_newton = norm(out.force);
  for (int i = 0; i < 500; ++i) {
    out = sut.loop.tick({x_m, 0, 0}, {});
    EXPECT_LE(norm(out.force), last_newton + 1e-9);
    EXPECT_GE(norm(out.force), last_newton - 0.05);
    last_newton = norm(out.force);
  }
  EXPECT_EQ(out.force, Force3{});
  EXPECT_TRUE(out.is_fading);
  // Deep in matter by now.
  for (int i = 0; i < 100; ++i) out = sut.loop.tick({x_m += 0.0002, 0, 0}, {});
  EXPECT_EQ(out.force, Force3{});
  sut.loop.is_up = true;
  last_newton = 0;
  for (int i = 0; i < 400; ++i) {
    out = sut.loop.tick({x_m, 0, 0}, {});
    EXPECT_LE(norm(out.force), last_newton + 0.05);
    last_newton = norm(out.force);
  }
  EXPECT_GT(last_newton, 0);
}

TEST(Composite, ArmThatStartsAnewKeepsTheMapOfItsSessionAndForgetsThatOfAnother) {
  Composed sut(room(), kTick, delayed_by(0.02));
  (void)sut.rest({}, 0.4);
  const std::uint64_t trusted = sut.arm.counters().trusted;
  sut.arm.reset(sut.loop.now(), {});
  (void)sut.rest({}, 0.2);
  EXPECT_LE(sut.arm.counters().trusted, trusted + 1) << "until the next answer";
  sut.world.close();
  ASSERT_TRUE(sut.world.open(sut.rest({}, 0).sample));
  sut.loop.is_up = false;
  HandSample asked;
  asked.sequence = 1'000'000;
  ConstraintSet set = sut.world.answer(asked, kTick);
  set.map.blocks.clear();
  const ArmOutput out = sut.arm.step({.now = sut.loop.now(), .dt = kTick, .fresh = &set});
  EXPECT_FALSE(out.sample.has_ghost);
}

// A world of cells that says when all of them were replaced.
class Loaded final : public world::World {
 public:
  explicit Loaded(world::VoxelWorld& cells) : cells_(cells) {}
  [[nodiscard]] const world::WorldInfo& info() const noexcept override { return cells_.info(); }
  [[nodiscard]] const VoxelGrid* grid() const noexcept override { return cells_.grid(); }
  [[nodiscard]] std::uint32_t loads() const noexcept override { return count; }
  [[nodiscard]] Result<world::ProbeId> add_probe(Position3 hand) override {
    return cells_.add_probe(hand);
  }
  void remove_probe(world::ProbeId probe) noexcept override { cells_.remove_probe(probe); }
  world::ProbeMotion move_probe(world::ProbeId probe, Position3 hand,
                                Duration dt) noexcept override {
    return cells_.move_probe(probe, hand, dt);
  }
  std::uint32_t count{0};

 private:
  world::VoxelWorld& cells_;
};

// One answer comes after the change, and tells of the blocks beside the hand only; then the world
// is silent. Of cells that were edited one by one the others are thought to be what they were.
TEST(Composite, CellsThatWereAllReplacedAtOnceAreFeltNoMore) {
  for (const bool is_loaded : {false, true}) {
    Composed told(room(), kTick, delayed_by(0));
    fill_from(told, 17, true);
    Loaded world(told.cells);
    CompositeArm sut(in_cells_of(kCell_m));
    CompositeWorld half(world, 1);
    testing::LinkedLoop loop(sut, half, kTick, delayed_by(0));
    double x_m = -0.08;
    for (int i = 0; i < 300; ++i) (void)loop.tick({x_m, 0, 0}, {});
    fill_from(told, 17, false);
    for (std::int32_t x : {7, 15}) {
      for (std::int32_t y : {0, 8}) {
        for (std::int32_t z : {0, 8}) told.cells.set_cell({x, y, z}, true);
      }
    }
    if (is_loaded) ++world.count;
    for (int i = 0; i < 2; ++i) (void)loop.tick({x_m, 0, 0}, {});
    loop.is_up = false;
    bool is_felt = false;
    for (int i = 0; i < 150; ++i) {
      const ArmOutput out = loop.tick({x_m += 0.001, 0, 0}, {1, 0, 0});
      is_felt = is_felt || out.force != Force3{};
    }
    EXPECT_EQ(is_felt, !is_loaded);
    loop.is_up = true;
    ArmOutput out;
    for (int i = 0; i < 300; ++i) out = loop.tick({x_m, 0, 0}, {});
    EXPECT_TRUE(out.sample.has_ghost) << "the new cells are told of";
    EXPECT_EQ(out.force, Force3{});
  }
}

TEST(Composite, AGhostThatCameThroughOtherCellsIsNotAstray) {
  Composed sut(room(), kTick, delayed_by(0));
  const std::uint64_t now = sut.world.cells_epoch();
  ASSERT_TRUE(sut.world.open(testing::sample(1, {})));
  HandSample told = testing::sample(2, {});
  told.has_ghost = true;
  told.ghost = {0.05, 0, 0};
  const std::array<std::pair<std::uint64_t, bool>, 3> cases{
      {{now, true}, {now + 1, false}, {0, true}}};
  for (const auto& [epoch, is_astray] : cases) {
    ++told.sequence;
    told.epoch = epoch;
    EXPECT_EQ(sut.world.answer(told, kTick).is_astray, is_astray) << epoch;
  }
}

// The same place has another number in finer cells, and that number another place.
TEST(Composite, AWorldThatComesBackOfOtherCellsMovesNothing) {
  for (const std::uint32_t session : {1U, 2U}) {
    world::VoxelWorld coarse(VoxelGrid::create({64, 64, 64}, 0.001).value(), "coarse");
    CompositeWorld world(coarse, 1);
    const Position3 tip{-0.0303, 0, 0};  // in cell 1, and in cell 3 of half the edge
    ASSERT_TRUE(world.open(testing::sample(1, tip)));
    CompositeArm sut(in_cells_of(0.001));
    sut.reset({}, tip);
    ConstraintSet set = world.answer(testing::sample(1, tip), kTick);
    ASSERT_TRUE(
        sut.step({.now = {kTick}, .dt = kTick, .tip = tip, .fresh = &set}).sample.has_ghost);
    // Of half the edge, with a slab between the place of the hand and that of its old cell.
    const VoxelGrid fine = VoxelGrid::create({128, 128, 128}, 0.0005).value();
    ++set.sequence;
    set.session = session;
    set.map.lattice = fine.lattice();
    set.map.ghost_cell = {3, 64, 64};
    set.map.blocks.clear();
    for (const std::int16_t at : {std::int16_t{4}, std::int16_t{8}}) {
      world::OccupancyBlock slab{.at = {0, at, at}, .version = 1};
      slab.slices.fill(0x0404040404040404);  // x = 2
      set.map.blocks.push_back(slab);
    }
    const Position3 moved{tip.x + 1e-5, 0, 0};
    const ArmOutput out = sut.step({.now = {2 * kTick}, .dt = kTick, .tip = moved, .fresh = &set});
    EXPECT_EQ(out.offset, Displacement3{}) << session;
    EXPECT_EQ(out.force, Force3{});
    EXPECT_EQ(out.sample.ghost, moved);
  }
}

// A hand of 0.15 kg on a spring before matter that comes and goes.
TEST(Composite, AWorldThatChangesGivesTheHandNoMoreThanItsShiftsStore) {
  for (const double delay_s : {0.005, 0.05, 0.2}) {
    Composed sut(room(), kTick, delayed_by(delay_s));
    (void)sut.rest({-0.03, 0, 0}, delay_s + 0.2);
    std::mt19937_64 random(731);
    fill_from(sut, 13, true);
    double x_m = -0.03;
    double work_joule = 0;
    double last_force_newton = 0;
    double most_joule = 0;
    for (int i = 0; i < 4000; ++i) {
      // Against the wall and back at 1 Hz, while cells far behind its face come and go.
      const double goal_m = 0.02 + 0.02 * std::sin(2 * 3.14159265358979 * i / 1000.0);
      const double before_m = x_m;
      x_m += std::clamp(goal_m - x_m, -0.0002, 0.0002);
      work_joule += last_force_newton * (x_m - before_m);
      most_joule = std::max(most_joule, work_joule);
      if (i % 50 == 0) sut.cells.set_cell({17, static_cast<int>(random() % 9), 4}, i % 100 == 0);
      const ArmOutput out = sut.loop.tick({x_m, 0, 0}, {(x_m - before_m) * 1000, 0, 0});
      last_force_newton = out.force.x;
    }
    EXPECT_LT(most_joule, 0.001) << delay_s;
  }
}

TEST(Composite, AMapThatCannotBeIsAsGoodAsNone) {
  const VoxelGrid grid = room();
  std::mt19937_64 random(730);
  for (int run = 0; run < 300; ++run) {
    CompositeArm sut(in_cells_of(kCell_m));
    sut.reset({}, {});
    for (int i = 1; i <= 300; ++i) {
      ConstraintSet set;
      set.sequence = random() % 8 == 0 ? random() : static_cast<std::uint64_t>(i);
      set.session = random() % 20 == 0 ? 2 : 1;
      set.answers = random() % 4 == 0 ? random() : static_cast<std::uint64_t>(i);
      set.has_ghost = random() % 8 != 0;
      set.has_map = random() % 8 != 0;
      set.is_astray = random() % 2 == 0;
      set.map.lattice = grid.lattice();
      set.map.is_plane = random() % 8 == 0;
      set.map.ghost_cell = {10, 4, 4};
      for (std::size_t b = random() % 5; b-- > 0;) {
        world::OccupancyBlock block;
        for (auto& place : block.at) place = static_cast<std::int16_t>(random() % 4 - 1);
        block.version = static_cast<std::uint32_t>(random() % 1000);
        for (auto& slice : block.slices) slice = random() & random() & random();
        set.map.blocks.push_back(block);
      }
      switch (random() % 6) {
        case 0:
          set.map.lattice.cells[random() % 3] = static_cast<std::uint32_t>(random());
          break;
        case 1:
          set.map.lattice.half_cell_m = random() % 2 == 0 ? kNotANumber : -1;
          break;
        case 2:
          set.map.ghost_cell[random() % 3] = static_cast<std::int32_t>(random());
          break;
        case 3:
          set.ghost[random() % 3] = random() % 2 == 0 ? kNotANumber : 1e9;
          break;
        default:
          break;
      }
      const Position3 tip{0.0004 * (i % 100), 0.0003 * (i % 77), -0.0004 * (i % 55)};
      const ArmOutput out = sut.step({.now = {kTick * i}, .dt = kTick, .tip = tip, .fresh = &set});
      ASSERT_TRUE(is_finite(out.force));
      ASSERT_TRUE(is_finite(out.sample.hand));
      ASSERT_TRUE(!out.sample.has_ghost || is_finite(out.sample.ghost));
    }
  }
}

TEST(Composite, AWorldWithoutCellsIsRefused) {
  testing::FakeBox box(0.015);
  CompositeWorld sut(box, 1);
  EXPECT_EQ(sut.open(testing::sample(1, {})).error().code, Errc::Unsupported);
  EXPECT_EQ(box.probes, 0);
}

TEST(Composite, AHandOrTipThatIsNowhereLeavesBothHalvesAsTheyWere) {
  world::VoxelWorld cells(room(), "room");
  CompositeWorld world(cells, 1);
  EXPECT_EQ(world.open(testing::sample(1, {kNotANumber, 0, 0})).error().code,
            Errc::InvalidArgument);
  ASSERT_TRUE(world.open(testing::sample(1, {})));
  const ConstraintSet good = world.answer(testing::sample(1, {}), kTick);
  EXPECT_EQ(world.answer(testing::sample(2, {0, kNotANumber, 0}), kTick).sequence, good.sequence);
  EXPECT_EQ(world.answer(testing::sample(1, {0.01, 0, 0}), kTick).sequence, good.sequence)
      << "overtaken";
  Composed sut(room(), kTick, {});
  fill_from(sut, 13, true);
  const double face_m = sut.cells.grid()->face_m(0, 13);
  (void)sut.rest({0.020, 0, 0}, 0.3);
  const ArmOutput bad =
      sut.arm.step({.now = sut.loop.now(), .dt = kTick, .tip = {kNotANumber, 0, 0}});
  EXPECT_TRUE(std::isnan(bad.force.x));
  const ArmOutput out = sut.loop.tick({face_m + 0.0004, 0, 0}, {});
  EXPECT_NEAR(out.force.x, -800 * 0.0004, 1e-9);
}

}  // namespace
}  // namespace thimble::coupling
