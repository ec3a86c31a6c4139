#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "daemon/world/cam/piece_world.hpp"
#include "tests/support/arm_watch.hpp"

// A world on a CAM board behind USB, felt by an arm; and its cable pulled.
namespace thimble {
namespace {

using test::ArmWatch;
using test::ClosedLoop;

// Walls 10 mm from the middle, and a small piece somewhere.
const std::vector<std::string> kPieces{
    "arm.hand.motion=still", "arm.world=desk",         "world.name=desk",
    "world.source=pieces",   "world.workspace_m=0.02", "world.pieces.cells=32",
    "world.pieces.count=1",  "world.pieces.boards=2",  "world.pieces.board=sim-usb"};

class BoardOnUsb : public testing::Test {
 protected:
  const world::cam::PieceBoard& pieces() {
    return loop_.runtime().worlds().front()->pieces()->board();
  }
  sim::cam::SimUsbCamBoard& plug() { return *loop_.runtime().worlds().front()->usb_board(); }
  void run(double s) {
    loop_.run(s, [&] { watch_->see(); });
  }
  bool is_pushed() { return loop_.frame().is_in_contact && norm(loop_.truth().motor_force) > 1; }
  void SetUp() override {
    loop_.run_until_leaning();
    ASSERT_TRUE(is_pushed());
    watch_.emplace(loop_);
    watch_->see();
  }
  // What the hand pushes against is gone, and nothing else happens to it.
  void expect_let_go() {
    EXPECT_EQ(loop_.frame().state, OperatingState::Active);
    EXPECT_EQ(loop_.frame().fault, FaultCode::None);
    EXPECT_EQ(norm(loop_.frame().force), 0);
    ASSERT_TRUE(pieces().trouble());
  }

  ClosedLoop loop_{kPieces};
  std::optional<ArmWatch> watch_;  // from the push on
};

TEST_F(BoardOnUsb, PulledOutDuringAProgramTheConstraintsFadeAndPluggedInTheyComeBack) {
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(loop_.run_until(1, [&] { return !pieces().is_ready(); })) << "it looks";
    plug().unplug();
    run(0.5);
    expect_let_go();
    const std::uint64_t resets = pieces().counters().resets;
    plug().replug();
    loop_.sim_arm().backend().push_tip({});
    run(1);
    EXPECT_FALSE(pieces().trouble()) << pieces().trouble()->message;
    EXPECT_EQ(pieces().counters().resets, resets + 1) << "its memory had no power";
    loop_.sim_arm().backend().push_tip({4.5, 0, 0});
    run(1);
    EXPECT_TRUE(is_pushed()) << "the wall is where it was";
    EXPECT_EQ(watch_->breach(), "");
  }
}

// Its memory had no power: the grasp point is in the middle at first, and the wall is not.
TEST_F(BoardOnUsb, AHandThatWentThroughTheWallMeanwhileFeelsItAsAnyOther) {
  const double pushed_newton = watch_->peak_motor_newton();
  plug().unplug();
  run(1);
  expect_let_go();
  const double beyond_m = loop_.frame().tip.x - 0.01;
  ASSERT_GT(beyond_m, 0.005);
  plug().replug();
  double most_offset_m = 0;
  loop_.run(1.5, [&] {
    watch_->see();
    most_offset_m = std::max(most_offset_m, norm(loop_.frame().offset));
  });
  EXPECT_TRUE(loop_.frame().is_in_contact);
  EXPECT_LE(most_offset_m, beyond_m + 0.001);
  EXPECT_LE(watch_->peak_motor_newton(), pushed_newton + 0.1);
  EXPECT_EQ(watch_->breach(), "");
}

TEST_F(BoardOnUsb, StandingStillItIsGivenUp) {
  plug().freeze();
  run(1.5);
  expect_let_go();
  EXPECT_EQ(watch_->breach(), "");
}

}  // namespace
}  // namespace thimble
