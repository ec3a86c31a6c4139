#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

#include "daemon/world/voxel_world.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/closed_loop.hpp"

// Cells that change under the hand, 1000 times a second: what no edit may do to the person who
// holds the arm, and where the ghost is meanwhile (docs/ghost-motion.md, "Cells that fill").
namespace thimble {
namespace {

using Kind = world::CellEdit::Kind;
using test::ClosedLoop;

constexpr std::int32_t kCells = 32;

class EditedWorld {
 public:
  explicit EditedWorld(const std::string& delay_s)
      : delay_s_(std::stod(delay_s)),
        loop_({"world.source=box:32", "arm.impairment.delay_s=" + delay_s, "arm.hand.reach_m=0.03",
               "arm.hand.speed_m_per_s=0.15"}),
        watch_(loop_),
        world_(*loop_.world().editable()),
        host_(*loop_.runtime().worlds().front()) {
    for (world::Cell cell; cell.z < kCells; ++cell.z) {
      for (cell.y = 0; cell.y < kCells; ++cell.y) {
        for (cell.x = 0; cell.x < kCells; ++cell.x) world_.set_cell(cell, random_() % 4 == 0);
      }
    }
    loop_.run_until_driven();
  }

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const auto submitted = host_.submit_edits({random_edit(), random_edit()});
      ASSERT_TRUE(submitted) << submitted.error().message;
      loop_.tick();
      watch_.see();
      see_ghost();
      see_energy();
    }
  }

  ClosedLoop& loop() { return loop_; }
  [[nodiscard]] const std::string& breach() const { return watch_.breach(); }
  [[nodiscard]] std::uint64_t edits() const { return host_.edits()->applied(); }
  [[nodiscard]] int buried() const { return buried_; }
  [[nodiscard]] int embedded() const { return embedded_; }
  [[nodiscard]] double excess_j() const { return excess_j_; }
  [[nodiscard]] double given_j() const { return largest_given_j_; }
  [[nodiscard]] double moved_j() const { return largest_moved_j_; }
  [[nodiscard]] double peak_newton() const { return watch_.peak_sent_newton(); }

 private:
  [[nodiscard]] Position3 hand() { return loop_.frame().tip + loop_.frame().offset; }
  [[nodiscard]] std::int32_t near(std::size_t axis) {
    const std::int32_t middle = world_.grid()->lower_index(axis, hand()[axis]);
    return std::clamp(middle + static_cast<std::int32_t>(random_() % 7) - 3, 0, kCells - 1);
  }
  world::CellEdit random_edit() {
    world::CellEdit edit;
    edit.kind = static_cast<Kind>(random_() % 3);
    edit.value = static_cast<std::uint8_t>(random_() % 3 == 0 ? 1 : 0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      edit.first[axis] = near(axis);
      edit.last[axis] = std::min<std::int32_t>(
          edit.first[axis] + static_cast<std::int32_t>(random_() % 3), kCells - 1);
      edit.center[axis] = hand()[axis] + 0.002 * (static_cast<double>(random_() % 7) - 3);
    }
    edit.radius_m = 0.001 * static_cast<double>(1 + random_() % 6);
    return edit;
  }

  // The arm's own ghost: a hand that is not finite is told where it is, and leaves it there.
  void see_ghost() {
    const world::ProbeMotion motion = world_.move_probe(kArmsProbe, kNoHand, Duration(1));
    ASSERT_TRUE(is_finite(motion.ghost)) << "its session is another one";
    if (motion.is_embedded) {
      ++embedded_;
      embedded_at_s_ = seconds(loop_.now().since_epoch);
      return;
    }
    // Inside of one cell, not on its faces, and that cell filled: that must not be.
    world::Cell cell;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double in_cells = motion.ghost[axis] / world_.info().cell_m + kCells / 2.0;
      cell[axis] = static_cast<std::int32_t>(std::floor(in_cells));
      if (std::abs(in_cells - std::round(in_cells)) < 1e-9) return;
    }
    if (world_.is_occupied(cell)) ++buried_;
  }

  // From one touch to the next, as BoxWatch has it: a contact may give what the ghost point may
  // give. A wall that moves on its own does work beyond that: its force at the speed of push-out,
  // while the arm knows of a ghost in matter, and at that of the frame's return while it returns.
  void see_energy() {
    const servo::ServoFrame& frame = loop_.frame();
    const plugin::ArmTruth truth = loop_.truth();
    if (norm(truth.motor_force) == 0 && !frame.is_in_contact) {
      given_j_ = moved_j_ = rounded_j_ = offset_m_ = 0;
      contacts_before_ = frame.contacts;
    }
    const double dt_s = seconds(frame.dt);
    given_j_ += dot(truth.motor_force, truth.tip_velocity) * dt_s;
    const bool is_pushed = seconds(loop_.now().since_epoch) <= embedded_at_s_ + delay_s_ + kReach_s;
    const bool is_returning = norm(frame.offset) < norm(offset_before_);
    offset_before_ = frame.offset;
    moved_j_ +=
        norm(truth.motor_force) * dt_s * ((is_pushed ? 0.10 : 0) + (is_returning ? 0.025 : 0));
    if (norm(truth.motor_force) > 0)
      rounded_j_ += kQuantum_newton * norm(truth.tip_velocity) * dt_s;
    offset_m_ = std::max(offset_m_, norm(frame.offset));
    const double allowed_j = moved_j_ + rounded_j_ +
                             (frame.contacts - contacts_before_) * 0.5 * 800 * 0.0005 * 0.0005 +
                             0.5 * 50 * offset_m_ * offset_m_;
    largest_moved_j_ = std::max(largest_moved_j_, moved_j_);
    largest_given_j_ = std::max(largest_given_j_, given_j_);
    excess_j_ = std::max(excess_j_, given_j_ - allowed_j);
  }

  static constexpr world::ProbeId kArmsProbe{1};  // the world's first
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  static constexpr Position3 kNoHand{kNan, kNan, kNan};
  static constexpr double kQuantum_newton = 0.02;  // motors take steps of 1 mA, as in ArmWatch
  static constexpr double kReach_s = 0.006;        // from the world to the motors: ticks, bus, PWM

  std::mt19937 random_{17};
  double delay_s_;
  ClosedLoop loop_;
  test::ArmWatch watch_;
  world::VoxelWorld& world_;
  session::WorldHost& host_;
  int buried_{0};
  int embedded_{0};
  double embedded_at_s_{-1};
  double given_j_{0};
  double moved_j_{0};
  double rounded_j_{0};
  double offset_m_{0};
  Displacement3 offset_before_{};
  std::uint32_t contacts_before_{0};
  double largest_given_j_{0};
  double largest_moved_j_{0};
  double excess_j_{-1e9};
};

TEST(EditedWorld, AHundredThousandEditsUnderTheHandBreakNoRule) {
  for (const char* delay_s : {"0", "0.02"}) {
    EditedWorld sut(delay_s);
    sut.run(60000);
    EXPECT_EQ(sut.breach(), "") << delay_s;
    EXPECT_EQ(sut.buried(), 0) << delay_s;
    EXPECT_EQ(sut.loop().snapshot().faults, 0U) << delay_s;
    EXPECT_GE(sut.edits(), 100000U);
    EXPECT_LE(sut.excess_j(), 0) << delay_s;
    EXPECT_LT(sut.moved_j(), 0.05) << "an allowance that nothing can exceed shows nothing";
    // It was no walk in the open: matter came over the ghost, and was felt.
    EXPECT_GT(sut.embedded(), 1000);
    EXPECT_GT(sut.loop().snapshot().total_contacts, 500U);
    std::printf(
        "%llu edits, %s s of delay: ghost in matter in %d of 60000 ticks, contacts %llu, peak "
        "%.2f N, a touch gave %.2g J at most, walls that moved may give %.2g J, excess %.2g J\n",
        static_cast<unsigned long long>(sut.edits()), delay_s, sut.embedded(),
        static_cast<unsigned long long>(sut.loop().snapshot().total_contacts), sut.peak_newton(),
        sut.given_j(), sut.moved_j(), sut.excess_j());
  }
}

// The ghost of a still hand in a cell that fills: pushed out, felt as a force that grows from zero.
TEST(EditedWorld, MatterThatComesOverARestingFingerPushesItOutWithoutAJump) {
  ClosedLoop loop({"world.source=box:32", "arm.hand.motion=still"});
  loop.run_until_driven();
  test::ArmWatch watch(loop);
  session::WorldHost& host = *loop.runtime().worlds().front();
  const Position3 hand = loop.frame().tip + loop.frame().offset;
  ASSERT_TRUE(host.submit_edits({{Kind::Paint, {}, {}, hand, 0.004, 1}}));
  double largest_step_newton = 0;
  Force3 before = loop.frame().wish;
  double peak_newton = 0;
  loop.run(1.0, [&] {
    watch.see();
    largest_step_newton = std::max(largest_step_newton, norm(loop.frame().wish - before));
    before = loop.frame().wish;
    peak_newton = std::max(peak_newton, norm(before));
  });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_GT(peak_newton, 0.2);
  EXPECT_LT(largest_step_newton, 0.5);
  ASSERT_TRUE(host.submit_edits({{Kind::Fill, {}, {31, 31, 31}, {}, 0, 0}}));
  loop.run(0.2, [&] { watch.see(); });
  EXPECT_EQ(watch.breach(), "");
  EXPECT_EQ(norm(loop.frame().wish), 0) << "what was cleared holds nobody";
}

// A world that is filled altogether lets go of the hand, and has it again when it is cleared.
TEST(EditedWorld, AFillOfEverythingReleasesTheHandAndTheLoopGoesOn) {
  ClosedLoop loop({"world.source=box:128"});
  loop.run_until_driven();
  test::ArmWatch watch(loop);
  session::WorldHost& host = *loop.runtime().worlds().front();
  ASSERT_TRUE(host.submit_edits({{Kind::Fill, {}, {127, 127, 127}, {}, 0, 1}}));
  loop.run(3.0, [&] { watch.see(); });
  EXPECT_TRUE(host.edits()->is_idle());
  EXPECT_EQ(host.world().occupied_cells(), 128U * 128 * 128);
  EXPECT_EQ(norm(loop.frame().wish), 0);
  EXPECT_EQ(loop.frame().state, OperatingState::Active);
  ASSERT_TRUE(host.submit_edits({{Kind::Fill, {43, 43, 43}, {84, 84, 84}, {}, 0, 0}}));
  const auto contacts = loop.snapshot().total_contacts;
  loop.run(10.0, [&] { watch.see(); });
  EXPECT_GT(loop.snapshot().total_contacts, contacts);
  EXPECT_EQ(watch.breach(), "");
}

TEST(EditedWorld, TheSphereRefuses) {
  const std::string text = R"(
[[world]]
name = "hello"
source = "sphere"
[[arm]]
name = "right"
device = "sim:phantom-vintage"
amplifier_max_a = 3.0
world = "hello"
)";
  ClosedLoop loop({}, {text, {}, {}});
  const auto refused = loop.runtime().worlds().front()->submit_edits({{}});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::Unsupported);
  EXPECT_EQ(refused.error().message,
            "world 'hello': sphere is made of no cells, so none can be edited");
}

}  // namespace
}  // namespace thimble
