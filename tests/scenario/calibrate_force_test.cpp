#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/force_fit.hpp"
#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/support/closed_loop.hpp"

// A kitchen scale under the grip of a Falcon whose counts are not what its driver thinks.
namespace thimble {
namespace {

constexpr double kAssumed_newton = 0.0025;

// Carries the tip from below, steadies it from the sides, and shows whole grams.
class KitchenScale final : public plugin::TipLoad {
 public:
  Force3 force_on_tip(MonotonicTime, Duration, Position3 tip,
                      Velocity3 velocity) noexcept override {
    const double carried_newton = -4000 * tip.y - 30 * velocity.y;
    shown_newton_ += 0.001 * (carried_newton - shown_newton_);
    return {-400 * tip.x - 10 * velocity.x, carried_newton, -400 * tip.z - 10 * velocity.z};
  }
  [[nodiscard]] bool is_button_pressed(MonotonicTime) const noexcept override { return false; }
  [[nodiscard]] double gram() const { return std::round(shown_newton_ / 9.80665e-3); }

 private:
  double shown_newton_{0};
};

class CalibrateForce : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(, CalibrateForce, testing::Values(0.7, 1.0, 1.3), [](const auto& of) {
  return std::to_string(std::lround(of.param * 100));
});

TEST_P(CalibrateForce, FindsTheScaleOfASimulatedArmWithinFivePercent) {
  plugin::SimModelEntry off{"falcon-off", "a Falcon of another scale"};
  off.create_usb = [](const plugin::SimModelSettings&) {
    sim::FalconParameters parameters = sim::falcon_parameters();
    parameters.newton_per_count = kAssumed_newton * GetParam();
    auto arm = std::make_unique<sim::FalconArmModel>(parameters);
    arm->load_firmware();
    return arm;
  };
  test::ClosedLoop::Setup setup;
  setup.bring = [&](session::Plugins& plugins) { plugins.models.add(off); };
  test::ClosedLoop sut(
      {"arm.0.device=sim:falcon-off", "arm.0.model=falcon", "arm.hand.motion=still",
       "arm.0.newton_per_count=" + std::to_string(kAssumed_newton)},
      setup);
  sut.run_until_driven();
  KitchenScale scale;
  sut.sim_arm().backend().hold_tip(&scale);
  std::vector<cli::ScaleReading> readings;
  for (const double newton : cli::even_forces_newton(400 * kAssumed_newton, 6)) {
    coupling::SteadyForce& force = sut.arm().session().steady_force();
    force.hold(-newton);
    sut.run(2, [&] { force.keep(); });
    ASSERT_EQ(sut.frame().state, OperatingState::Active)
        << to_string(sut.snapshot().fault.code) << " at " << newton << " N";
    readings.push_back({-sut.frame().force.y, scale.gram()});
  }
  const auto found = cli::fit_force(readings, kAssumed_newton);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->newton_per_count, kAssumed_newton * GetParam(),
              0.05 * kAssumed_newton * GetParam());

  sut.arm().session().steady_force().release();
  sut.run(0.5);
  EXPECT_LT(norm(sut.frame().force), 0.5) << "the world again, and no jump";
  EXPECT_EQ(sut.snapshot().fault.code, FaultCode::None);
  sut.sim_arm().backend().hold_tip(nullptr);
}

TEST(SteadyForceInASession, IsLimitedAsEveryWishIs) {
  test::ClosedLoop sut({"arm.hand.motion=still", "arm.0.limits.force_newton=2"});
  sut.run_until_driven();
  sut.arm().session().steady_force().hold(-8);
  sut.run(0.01);
  EXPECT_LE(norm(sut.frame().force), 2 + 1e-9);
  sut.controls().is_estop_healthy = false;
  sut.tick();
  EXPECT_EQ(norm(sut.frame().force), 0);
}

}  // namespace
}  // namespace thimble
