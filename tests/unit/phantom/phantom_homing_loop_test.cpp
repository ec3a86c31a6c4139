#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <random>

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/hid_link.hpp"
#include "drivers/phantom/phantom_device.hpp"
#include "tests/unit/phantom/scripted_hid.hpp"

namespace thimble::phantom {
namespace {

using Counts = std::array<std::int32_t, 3>;

// The controller of the sheet in a few lines: counters with a zero, a flag, command 1.
struct PlainController {
  Counts turned{};  // true motor positions
  Counts zero{};
  bool has_flag{false};
  int currents_seen{0};

  void take(const std::vector<std::uint8_t>& bytes) {
    for (std::size_t i = 0; i < 6; ++i) currents_seen += bytes[i] != 0 ? 1 : 0;
    if (bytes[6] != 1) return;
    zero = turned;
    has_flag = false;
  }
  [[nodiscard]] std::array<int, 7> report() const {
    return {turned[0] - zero[0], turned[1] - zero[1], turned[2] - zero[2], 0, 0, 0,
            has_flag ? 1 : 0};
  }
};

// Carries reports both ways, some frames late and some never.
class BadCable {
 public:
  BadCable(std::mt19937& random, int loss_percent, std::size_t late_frames)
      : random_(random), loss_percent_(loss_percent), late_frames_(late_frames) {}

  void frame(HidScript& host, PlainController& controller) {
    to_host_.push_back(controller.report());
    if (!host.submitted.empty()) to_device_.push_back(host.submitted.back());
    host.submitted.clear();
    host.now = host.now + wire::kSamplePeriod;
    if (to_host_.size() > late_frames_) {
      if (!is_lost()) host.arrive(to_host_.front(), Duration{});
      to_host_.pop_front();
    }
    if (to_device_.size() > late_frames_) {
      if (!is_lost()) controller.take(to_device_.front());
      to_device_.pop_front();
    }
  }

 private:
  bool is_lost() { return std::uniform_int_distribution<int>(0, 99)(random_) < loss_percent_; }
  std::mt19937& random_;
  int loss_percent_;
  std::size_t late_frames_;
  std::deque<std::array<int, 7>> to_host_;
  std::deque<std::vector<std::uint8_t>> to_device_;
};

struct Conditions {
  unsigned seed;
  int loss_percent;
  std::size_t late_frames;
};

class PhantomHomingLoop : public testing::TestWithParam<Conditions> {
 protected:
  void run_frame() {
    cable_.frame(script_, controller_);
    for (int tick = 0; tick < 4; ++tick) {  // a servo faster than the bus
      static_cast<void>(sut_.read(state_));
      static_cast<void>(sut_.write(LimitedWrench::zero()));
    }
  }
  void move(int largest_step) {
    std::uniform_int_distribution<int> step(-largest_step, largest_step);
    for (std::int32_t& turned : controller_.turned) turned += step(random_);
  }
  void keep_within_stops(const Counts& home) {
    for (std::size_t i = 0; i < 3; ++i) {
      controller_.turned[i] = std::clamp(controller_.turned[i], home[i] - 6000, home[i] + 6000);
    }
  }
  void expect_true_pose(const Counts& home, int tolerance_counts) {
    std::array<EncoderCounts, 3> truth{};
    for (std::size_t i = 0; i < 3; ++i) truth[i].value = controller_.turned[i] - home[i];
    const BodyAngles expected = body_angles(model_, truth);
    for (std::size_t i = 0; i < 3; ++i) {
      const double count_rad = body_angles(model_, {{{1}, {1}, {1}}})[i] - model_.home_angle_rad[i];
      EXPECT_NEAR(state_.joint_position_rad[i], expected[i], (tolerance_counts + 1e-6) * count_rad);
    }
  }

  std::mt19937 random_{GetParam().seed};
  const PhantomModel& model_{*find_model("phantom-vintage")};
  HidScript script_;
  PhantomDevice sut_{
      std::make_unique<HidLink>(std::make_unique<ScriptedHid>(script_), ReportForm::Mbed), model_,
      3};
  HapticState state_;
  PlainController controller_;
  BadCable cable_{random_, GetParam().loss_percent, GetParam().late_frames};
};

INSTANTIATE_TEST_SUITE_P(Cables, PhantomHomingLoop,
                         testing::Values(Conditions{1, 0, 0}, Conditions{2, 0, 1},
                                         Conditions{3, 20, 1}, Conditions{4, 20, 3},
                                         Conditions{5, 50, 3}, Conditions{6, 70, 0}));

// A hand that trembles by two counts while it presses, then explores.
TEST_P(PhantomHomingLoop, FindsTheHomePoseWithinATremor) {
  for (int frame = 0; frame < 50; ++frame) {
    move(300);
    run_frame();
  }
  EXPECT_EQ(state_.calibration, CalibrationState::NeedsUser);
  const Counts home = controller_.turned;
  controller_.has_flag = true;
  int frames = 0;
  while (state_.calibration != CalibrationState::Ok && ++frames < 1000) {
    controller_.turned = home;
    move(2);
    run_frame();
  }
  ASSERT_EQ(state_.calibration, CalibrationState::Ok) << "after " << frames << " frames";
  for (int frame = 0; frame < 2000; ++frame) {
    move(200);
    keep_within_stops(home);
    run_frame();
  }
  // Hold until the reports that are under way have come.
  for (int frame = 0; frame < 100; ++frame) run_frame();
  ASSERT_EQ(state_.calibration, CalibrationState::Ok);
  expect_true_pose(home, 2);
  EXPECT_EQ(controller_.currents_seen, 0);
}

// The arm was carried away after a press that nobody saw.
TEST_P(PhantomHomingLoop, DoesNotBelieveAPressOfBeforeItsTime) {
  controller_.has_flag = true;
  for (int frame = 0; frame < 300; ++frame) {
    move(50);
    run_frame();
    ASSERT_NE(state_.calibration, CalibrationState::Ok);
  }
  EXPECT_FALSE(controller_.has_flag);
}

}  // namespace
}  // namespace thimble::phantom
