// A world on a CAM board that is found among the devices of the bus, as real ones are, felt by an
// arm on the same bus.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/model/cam/cam_usb_model.hpp"
#include "tests/scenario/two_real_arms.hpp"

namespace thimble {
namespace {

using test::kLeft;
using testing::HasSubstr;

// Walls 10 mm from the middle, and a small piece somewhere.
const std::vector<std::string> kDesk{"world.source=pieces", "world.workspace_m=0.02",
                                     "world.pieces.cells=32", "world.pieces.count=1",
                                     "world.pieces.board=usb"};
const bus::DeviceAddress kPlug{"usb:1-1"};
const bus::DeviceAddress kOtherPlug{"usb:1-2"};
// Until it is looked for again, found, opened and filled.
const double kFound_s = seconds(session::RetryPace::kLongest) + 1;

class PluggedInBoard : public testing::Test, protected test::TwoRealArms {
 protected:
  void SetUp() override {
    motion_ = sim::HandMotion::Still;
    plug(kLeft);
  }
  void plug_board(const bus::DeviceAddress& address, int log2_sites,
                  std::uint32_t clock_hz = 25'000'000) {
    const sim::cam::BoardOptions options{.shape = {{1, 1, 1}, log2_sites}, .clock_hz = clock_hz};
    auto model = std::make_unique<sim::cam::CamUsbModel>(options);
    model_ = model.get();
    ASSERT_TRUE(plugs_.plug(address, std::move(model)));
  }
  void push(const Force3& newton) {
    plugs_.arm_backend({test::kAddresses[kLeft]})->push_tip(newton);
  }
  sim::cam::CamMachine& machine() { return model_->board().machine(); }
  std::string trouble() { return sut_->worlds().front()->trouble(); }
  bool is_pushed() { return frame(kLeft).is_in_contact && norm(frame(kLeft).force) > 1; }
  // Whatever the board does, the arm goes on.
  void expect_well() {
    EXPECT_EQ(state(kLeft), OperatingState::Active);
    EXPECT_EQ(frame(kLeft).fault, FaultCode::None);
    EXPECT_EQ(forces_unasked_, 0);
  }
  void expect_felt_after(double s) {
    push({});
    run(s);
    EXPECT_EQ(trouble(), "");
    // No faster than a slow board's answers come: the wall is where it is, and not later.
    for (int tenths = 1; tenths <= 20; ++tenths) {
      push({4.5 * tenths / 20, 0, 0});
      run(0.1);
    }
    EXPECT_TRUE(is_pushed());
    expect_well();
  }

  sim::cam::CamUsbModel* model_{nullptr};  // the board plugged in last
};

TEST_F(PluggedInBoard, IsFeltWheneverItComesAndLetsGoWhenItIsPulledOut) {
  start(kDesk);
  run(5);
  push({4.5, 0, 0});
  run(1);
  EXPECT_THAT(trouble(), HasSubstr("no CAM board is plugged in over USB"));
  EXPECT_EQ(norm(frame(kLeft).force), 0);
  expect_well();
  plug_board(kPlug, 16);
  expect_felt_after(kFound_s);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(plugs_.unplug(kPlug));
    const double pushed = norm(frame(kLeft).force);
    double previous = pushed;
    for (int ms = 0; ms < 500; ++ms) {
      tick();
      EXPECT_LE(norm(frame(kLeft).force), pushed + 0.3);
      previous = norm(frame(kLeft).force);
    }
    EXPECT_EQ(previous, 0);
    EXPECT_NE(trouble(), "");
    expect_well();
    ASSERT_TRUE(plugs_.replug(kPlug));
    expect_felt_after(kFound_s);
  }
}

TEST_F(PluggedInBoard, TooSmallForTheWorldIsPassedOverForTheNext) {
  plug_board(kPlug, 6);
  start(kDesk);
  run(5);
  EXPECT_NE(trouble(), "");
  expect_well();
  plug_board(kOtherPlug, 16);
  expect_felt_after(2 * kFound_s);
}

// A list that never ends, as far as a host can tell; the page goes on beating.
TEST_F(PluggedInBoard, WhoseMachineHangsLetsGoLongBeforeItIsGivenUp) {
  plug_board(kPlug, 16);
  start(kDesk);
  expect_felt_after(kFound_s);
  constexpr std::uint64_t kClocksOfAMinute = 60 * 25'000'000ULL;
  machine().hang_for(kClocksOfAMinute);
  run(0.8);
  EXPECT_EQ(norm(frame(kLeft).force), 0);
  EXPECT_EQ(trouble(), "");
  expect_well();
  run(4);
  EXPECT_THAT(trouble(), HasSubstr("the list is not over"));
  expect_well();
  ASSERT_TRUE(plugs_.unplug(kPlug));
  run(0.5);
  ASSERT_TRUE(plugs_.replug(kPlug));
  expect_felt_after(kFound_s);
}

// A scan of 64 x 64 cells takes 2 ms then: what began within the last tick is not over.
TEST_F(PluggedInBoard, PulledOutWhileItsMachineScansLetsGoAndIsFeltAgain) {
  plug_board(kPlug, 16, 2'000'000);
  auto large = kDesk;
  large.emplace_back("world.pieces.cells=64");
  start(large);
  expect_felt_after(kFound_s);
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t scans = machine().counters().scans;
    for (int ms = 0; ms < 500 && machine().counters().scans == scans; ++ms) tick();
    ASSERT_EQ(machine().counters().scans, scans + 1) << "it looks, by one scan";
    ASSERT_EQ(trouble(), "");
    ASSERT_TRUE(plugs_.unplug(kPlug));
    run(0.5);
    EXPECT_EQ(norm(frame(kLeft).force), 0);
    EXPECT_NE(trouble(), "");
    expect_well();
    ASSERT_TRUE(plugs_.replug(kPlug));
    expect_felt_after(kFound_s);
  }
}

TEST_F(PluggedInBoard, NobodyWaitsForTheKernelThatOpensIt) {
  plug_board(kPlug, 16);
  board_work_.postpone(true);
  start(kDesk);
  run(5);
  EXPECT_THAT(trouble(), HasSubstr("looked for"));
  expect_well();
  board_work_.do_all();
  board_work_.postpone(false);
  expect_felt_after(kFound_s);
}

}  // namespace
}  // namespace thimble
