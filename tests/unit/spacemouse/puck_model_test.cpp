#include "sim/model/spacemouse/puck_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

namespace thimble::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

class PuckModelTest : public testing::Test {
 protected:
  // What the puck says in one frame; empty: nothing.
  static Bytes frame(PuckModel& puck, MonotonicTime& now) {
    now = now + puck.frame_period();
    puck.advance(now);
    std::array<std::uint8_t, bus::kMaxHidReportBytes> out{};
    const std::size_t size = puck.in_report(out);
    return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(size)};
  }
  MonotonicTime now_{};
};

TEST_F(PuckModelTest, IsSilentAtRestAndSaysZeroThreeTimesBeforeThat) {
  PuckModel sut(combined_puck());
  EXPECT_TRUE(frame(sut, now_).empty());
  sut.push_tip({100, 0, 0});
  Bytes said;
  for (int i = 0; i < 10; ++i) said = frame(sut, now_);
  EXPECT_EQ(said, (Bytes{1, 0x5e, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})) << "at its stop";
  sut.push_tip({});
  int zeros = 0;
  for (int i = 0; i < 50; ++i) {
    said = frame(sut, now_);
    if (said == Bytes{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}) ++zeros;
  }
  EXPECT_TRUE(said.empty());
  EXPECT_EQ(zeros, 3);
}

TEST_F(PuckModelTest, SaysTranslationAndRotationInTurnInTheSeparateLayout) {
  PuckModel sut(separate_puck());
  ASSERT_TRUE(sut.move_tip_to({}));
  sut.turn_stylus({PuckModel::kTilt_rad, 0, 0});
  sut.push_tip({0, -100, 0});
  for (int i = 0; i < 10; ++i) (void)frame(sut, now_);
  EXPECT_EQ(frame(sut, now_), (Bytes{1, 0, 0, 0, 0, 0x90, 0x01})) << "down is positive";
  EXPECT_EQ(frame(sut, now_), (Bytes{2, 0x90, 0x01, 0, 0, 0, 0}));
  sut.press_stylus_button(true);
  EXPECT_EQ(frame(sut, now_), (Bytes{3, 1, 0})) << "buttons come first";
  EXPECT_EQ(frame(sut, now_)[0], 1);
}

TEST_F(PuckModelTest, ItsCapGivesWayAsItsSpringSaysAndNoForceBreaksIt) {
  PuckModel sut(combined_puck());
  sut.push_tip({1, 0, 0});
  for (int i = 0; i < 50; ++i) (void)frame(sut, now_);
  EXPECT_NEAR(sut.truth().tip.x, 1 / PuckModel::kSpring_newton_per_m, 1e-6);
  sut.push_tip({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  for (int i = 0; i < 50; ++i) (void)frame(sut, now_);
  EXPECT_NEAR(sut.truth().tip.x, 0, 1e-6);
  EXPECT_FALSE(sut.move_tip_to({0.01, 0, 0}));
}

}  // namespace
}  // namespace thimble::sim
