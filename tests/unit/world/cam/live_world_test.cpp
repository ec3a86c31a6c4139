#include "daemon/world/cam/live_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace thimble::world::cam {
namespace {

using std::chrono::milliseconds;

constexpr Duration kTick = milliseconds(1);

// Matter that moves by one cell along x at each step, round the end of its row: an automaton whose
// future is known.
class Drift final : public Automaton {
 public:
  explicit Drift(CamAxes log2_cells, std::vector<std::uint64_t> matter)
      : log2_cells_(log2_cells), matter_(std::move(matter)) {}
  [[nodiscard]] CamAxes log2_cells() const noexcept override { return log2_cells_; }
  [[nodiscard]] std::uint64_t steps() const noexcept override { return steps_; }
  void step() override {
    std::vector<std::uint64_t> after(matter_.size());
    const std::size_t along_x = std::size_t{1} << log2_cells_[0];
    for (std::size_t cell = 0; cell < matter_.size() * 64; ++cell) {
      const std::size_t from = cell % along_x == 0 ? cell + along_x - 1 : cell - 1;
      after[cell / 64] |= (matter_[from / 64] >> (from % 64) & 1) << (cell % 64);
    }
    matter_ = after;
    ++steps_;
  }
  void read(std::span<std::uint64_t> matter) override {
    std::copy(matter_.begin(), matter_.end(), matter.begin());
  }
  void write(std::span<const std::uint64_t> changed,
             std::span<const std::uint64_t> matter) override {
    ++writes;
    for (std::size_t i = 0; i < matter_.size(); ++i) {
      matter_[i] = (matter_[i] & ~changed[i]) | (matter[i] & changed[i]);
    }
  }
  [[nodiscard]] bool mark_zone(std::int32_t cells, std::span<std::uint64_t> zone) override {
    ++marks;
    if (!can_mark) return false;
    const auto along_x = std::int64_t{1} << log2_cells_[0];
    for (std::size_t cell = 0; cell < matter_.size() * 64; ++cell) {
      bool is_near = false;
      const auto x = static_cast<std::int64_t>(cell) % along_x;
      for (std::int64_t by = -cells; by <= cells; ++by) {
        if (x + by < 0 || x + by >= along_x) continue;
        const auto other = static_cast<std::size_t>(static_cast<std::int64_t>(cell) + by);
        is_near = is_near || (matter_[other / 64] >> (other % 64) & 1) != 0;
      }
      const std::uint64_t bit = std::uint64_t{1} << (cell % 64);
      zone[cell / 64] = is_near ? zone[cell / 64] | bit : zone[cell / 64] & ~bit;
    }
    return true;
  }
  [[nodiscard]] AutomatonState save() override {
    AutomatonState state{"drift", log2_cells_, steps_, {}};
    for (std::size_t cell = 0; cell < matter_.size() * 64; ++cell) {
      state.sites.push_back(matter_[cell / 64] >> (cell % 64) & 1);
    }
    return state;
  }
  [[nodiscard]] Result<void> load(const AutomatonState& state) override {
    if (state.rule != "drift") return fail(Errc::InvalidArgument, "another rule");
    steps_ = state.steps;
    for (auto& word : matter_) word = 0;
    for (std::size_t cell = 0; cell < state.sites.size(); ++cell) {
      matter_[cell / 64] |= static_cast<std::uint64_t>(state.sites[cell]) << (cell % 64);
    }
    return {};
  }

  int writes{0};
  int marks{0};
  bool can_mark{true};

 private:
  CamAxes log2_cells_;
  std::vector<std::uint64_t> matter_;
  std::uint64_t steps_{0};
};

struct Bench {
  Drift* automaton{nullptr};
  std::unique_ptr<LiveWorld> world;
};

// 16 x 16 cells of 1 mm in a plane, or 16 x 16 x 16; all of column x = 12 is matter.
Bench column(bool is_plane, double steps_per_s = 10, double poke_cells = 2) {
  const CamAxes log2{4, 4, is_plane ? 0 : 4};
  std::vector<std::uint64_t> matter((std::size_t{1} << (log2[0] + log2[1] + log2[2])) / 64,
                                    0x1000100010001000);
  auto automaton = std::make_unique<Drift>(log2, std::move(matter));
  Bench bench;
  bench.automaton = automaton.get();
  bench.world =
      LiveWorld::create({0.016, steps_per_s, poke_cells, "drift"}, std::move(automaton)).value();
  return bench;
}

bool is_matter(LiveWorld& world, Cell cell) { return world.editable()->is_occupied(cell); }

TEST(LiveWorld, TakesAStepWhenItIsDueAndNoMoreThanOne) {
  Bench sut = column(true);
  EXPECT_EQ(sut.world->pump({}), MonotonicTime{milliseconds(100)});
  EXPECT_EQ(sut.world->pump({milliseconds(99)}), MonotonicTime{milliseconds(100)});
  EXPECT_EQ(sut.world->steps(), 0U);
  EXPECT_EQ(sut.world->pump({milliseconds(101)}), MonotonicTime{milliseconds(200)});
  EXPECT_EQ(sut.world->steps(), 1U);
  EXPECT_FALSE(is_matter(*sut.world, {12, 5, 0}));
  EXPECT_TRUE(is_matter(*sut.world, {13, 5, 0}));
  EXPECT_EQ(sut.world->occupied_cells(), 16U);
  // A thread that was away for five steps catches up none of them.
  EXPECT_EQ(sut.world->pump({milliseconds(620)}), MonotonicTime{milliseconds(720)});
  EXPECT_EQ(sut.world->steps(), 2U);
  EXPECT_EQ(sut.world->left_out(), 4U);
}

TEST(LiveWorld, StandsStillWhereItHasNoPace) {
  Bench sut = column(true, 0);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(sut.world->pump({std::chrono::seconds(i)}));
  EXPECT_EQ(sut.world->steps(), 0U);
}

TEST(LiveWorld, AHandIsHeldByMatterAndNeverWaitsForAStep) {
  Bench sut = column(true);
  const ProbeId probe = sut.world->add_probe({0, 0, 0.03}).value();
  // 0.004 m is where column 12 begins.
  const ProbeMotion motion = sut.world->move_probe(probe, {0.007, 0.0002, 0.031}, kTick);
  EXPECT_DOUBLE_EQ(motion.ghost.x, 0.004);
  EXPECT_EQ(motion.ghost.z, 0.031) << "the third axis is free";
  ASSERT_EQ(motion.planes.size(), 1U);
  EXPECT_EQ(motion.planes[0].normal.x, 1);
  EXPECT_EQ(sut.world->steps(), 0U);
}

// As fills do: pushed out a bounded way a tick, or released; never carried along at once.
TEST(LiveWorld, MatterThatComesOverAFingerPushesItOut) {
  Bench sut = column(false);
  const Position3 hand{0.0037, 0.0002, 0.0003};
  const ProbeId probe = sut.world->add_probe(hand).value();
  sut.world->pump({});
  MonotonicTime now{};
  Position3 before = sut.world->move_probe(probe, hand, kTick).ghost;
  bool was_embedded = false;
  double farthest_m = 0;
  for (int i = 0; i < 3000; ++i) {
    now = now + kTick;
    sut.world->pump(now);
    const ProbeMotion motion = sut.world->move_probe(probe, hand, kTick);
    was_embedded = was_embedded || motion.is_embedded;
    farthest_m = std::max(farthest_m, norm(motion.ghost - before));
    before = motion.ghost;
  }
  EXPECT_EQ(sut.world->steps(), 30U);
  EXPECT_TRUE(was_embedded);
  EXPECT_GT(farthest_m, 0);
  EXPECT_LE(farthest_m, 0.00031) << "to the nearer side, at its pace, and back when that is free";
}

TEST(LiveWorld, AButtonPokesAHoleWhichTheAutomatonHasFromThenOn) {
  Bench sut = column(true);
  const ProbeId probe = sut.world->add_probe({}).value();
  ASSERT_DOUBLE_EQ(sut.world->move_probe(probe, {0.007, 0.0002, 0}, kTick).ghost.x, 0.004);
  sut.world->press(probe, 1);
  // Within 2 mm of (4, 0.2): centres of cells at (4.5, -1.5) to (4.5, 1.5).
  EXPECT_EQ(sut.world->occupied_cells(), 12U);
  EXPECT_GT(sut.world->move_probe(probe, {0.007, 0.0002, 0}, kTick).ghost.x, 0.006);
  sut.world->pump({});
  sut.world->pump({milliseconds(100)});
  EXPECT_EQ(sut.automaton->writes, 1);
  EXPECT_EQ(sut.world->occupied_cells(), 12U);
  for (const int y : {6, 7, 8, 9}) EXPECT_FALSE(is_matter(*sut.world, {13, y, 0})) << y;
  EXPECT_TRUE(is_matter(*sut.world, {13, 5, 0}));
  sut.world->pump({milliseconds(200)});
  EXPECT_EQ(sut.automaton->writes, 1) << "nothing was changed since";
  sut.world->press(probe, 2);
  EXPECT_GT(sut.world->occupied_cells(), 12U);
  sut.world->press(probe, 4);
  sut.world->press({77}, 1);
  EXPECT_GT(sut.world->occupied_cells(), 12U) << "a third button, a strange probe";
}

TEST(LiveWorld, EditsAreToldTheAutomatonToo) {
  Bench sut = column(true);
  sut.world->pump({});
  sut.world->editable()->set_cell({3, 3, 0}, true);
  sut.world->pump({milliseconds(100)});
  EXPECT_TRUE(is_matter(*sut.world, {4, 3, 0}));
}

TEST(LiveWorld, IsSavedWithWhatWasChangedAndGoesOnFromThere) {
  Bench sut = column(true);
  sut.world->pump({});
  sut.world->pump({milliseconds(100)});
  sut.world->editable()->set_cell({3, 3, 0}, true);
  const AutomatonState state = sut.world->save();
  EXPECT_EQ(state.steps, 1U);
  Bench other = column(true);
  EXPECT_EQ(other.world->loads(), 0U);
  ASSERT_TRUE(other.world->load(state));
  EXPECT_EQ(other.world->loads(), 1U);
  EXPECT_EQ(*other.world->editable()->grid(), *sut.world->editable()->grid());
  EXPECT_EQ(other.world->steps(), 1U);
  AutomatonState strange = state;
  strange.rule = "life";
  const auto refused = other.world->load(strange);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "drift: another rule");
}

TEST(LiveWorld, RefusesWhatIsNoPaceRadiusOrWorkspace) {
  const auto made = [](double workspace_m, double steps_per_s, double poke_cells) {
    return LiveWorld::create(
               {workspace_m, steps_per_s, poke_cells, "drift"},
               std::make_unique<Drift>(CamAxes{3, 3, 0}, std::vector<std::uint64_t>(1)))
        .has_value();
  };
  EXPECT_TRUE(made(0.09, 1000, 64));
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    EXPECT_FALSE(made(bad, 10, 3));
    EXPECT_FALSE(made(0.09, bad, 3));
    EXPECT_FALSE(made(0.09, 10, bad));
  }
  EXPECT_FALSE(LiveWorld::create(
      {}, std::make_unique<Drift>(CamAxes{2, 2, 0}, std::vector<std::uint64_t>(1))));
}

// Matter in column 12 of 16, a zone of 2 cells; 13 and up lie near a wall of the world.
TEST(LiveWorld, HasItsZoneMarkedByTheAutomatonAfterEachStep) {
  Bench sut = column(true);
  EXPECT_TRUE(sut.world->is_in_zone({5, 5, 0})) << "nobody has asked for one";
  sut.world->mark_zone(2);
  EXPECT_FALSE(sut.world->is_in_zone({9, 5, 0}));
  EXPECT_TRUE(sut.world->is_in_zone({10, 5, 0}));
  EXPECT_TRUE(sut.world->is_in_zone({1, 5, 0})) << "the world has walls";
  EXPECT_FALSE(sut.world->is_in_zone({2, 5, 0}));
  EXPECT_TRUE(sut.world->is_in_zone({5, 14, 0}));
  (void)sut.world->pump({});
  (void)sut.world->pump({milliseconds(100)});
  EXPECT_FALSE(sut.world->is_in_zone({10, 5, 0})) << "the column has moved on";
  EXPECT_TRUE(sut.world->is_in_zone({11, 5, 0}));
  sut.world->mark_zone(1);
  EXPECT_TRUE(sut.world->is_in_zone({11, 5, 0})) << "the largest that anybody wants";
  EXPECT_EQ(sut.automaton->marks, 2);
}

TEST(LiveWorld, WhatIsEditedIsInTheZoneUntilItIsMarkedAgain) {
  Bench sut = column(true);
  sut.world->mark_zone(2);
  ASSERT_FALSE(sut.world->is_in_zone({5, 5, 0}));
  sut.world->editable()->set_cell({6, 5, 0}, true);
  EXPECT_TRUE(sut.world->is_in_zone({5, 5, 0}));
  EXPECT_TRUE(sut.world->is_in_zone({9, 9, 0})) << "whatever is not known to be far";
  (void)sut.world->pump({});
  (void)sut.world->pump({milliseconds(100)});
  EXPECT_TRUE(sut.world->is_in_zone({5, 5, 0})) << "the cell moved on to 7";
  EXPECT_FALSE(sut.world->is_in_zone({4, 5, 0}));
}

TEST(LiveWorld, WithoutMarksEverythingIsInTheZone) {
  Bench sut = column(true);
  sut.automaton->can_mark = false;
  sut.world->mark_zone(2);
  EXPECT_TRUE(sut.world->is_in_zone({5, 5, 0}));
}

}  // namespace
}  // namespace thimble::world::cam
