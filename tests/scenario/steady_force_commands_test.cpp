#include <gtest/gtest.h>

#include <optional>

#include "daemon/app/arm_commands.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

constexpr api::ClientId kHer{7};
constexpr api::ClientId kHim{8};

// A steady force is of who holds the arm, and of nobody for long.
class SteadyForceCommands : public testing::Test {
 protected:
  SteadyForceCommands() {
    loop_.run_until(2, [&] { return loop_.frame().state == OperatingState::Inactive; });
  }
  static api::Answer keep(std::optional<Result<api::Done>>& told) {
    return [&told](const Result<api::Done>& done) { told = done; };
  }
  void activate() {
    std::optional<Result<api::Done>> told;
    sut_.activate("right", kHer, keep(told));
    loop_.run_until(2.1, [&] {
      sut_.poll();
      return told.has_value();
    });
    loop_.run(1);
  }
  Result<api::Done> push(std::optional<double> up_newton, api::ClientId client = kHer) {
    std::optional<Result<api::Done>> told;
    sut_.steady_force("right", up_newton, client, keep(told));
    return told.value_or(fail(Errc::System, "not answered"));
  }
  void run(double s) {
    loop_.run(s, [this] { sut_.poll(); });
  }
  double up_newton() { return loop_.frame().force.y; }

  test::ClosedLoop loop_{{"arm.hand.motion=still", "arm.activate=false"}};
  app::Leases leases_{{{"right", false}}};
  app::ArmCommands sut_{loop_.runtime(), leases_, loop_.arm().clock()};
};

TEST_F(SteadyForceCommands, PushesForWhoHoldsTheArmAndForNobodyElse) {
  EXPECT_EQ(push(-1).error().code, Errc::Busy) << "not active";
  activate();
  EXPECT_EQ(push(-1, kHim).error().code, Errc::Busy);
  ASSERT_TRUE(push(-1));
  run(0.1);
  EXPECT_NEAR(up_newton(), -1, 1e-6);
  ASSERT_TRUE(push(0.5));
  run(0.1);
  EXPECT_NEAR(up_newton(), 0.5, 1e-6);
  ASSERT_TRUE(push(std::nullopt));
  run(0.1);
  EXPECT_LT(std::abs(up_newton()), 0.2);
}

TEST_F(SteadyForceCommands, EndsWithItsClient) {
  activate();
  ASSERT_TRUE(push(-1));
  run(0.1);
  sut_.client_gone(kHer);
  EXPECT_FALSE(loop_.arm().session().steady_force().is_held());
  run(1);
  EXPECT_EQ(up_newton(), 0);
  EXPECT_EQ(loop_.frame().state, OperatingState::Inactive);
}

TEST_F(SteadyForceCommands, EndsAfterAMinuteAndWithAFault) {
  activate();
  ASSERT_TRUE(push(-1));
  run(59.9);
  EXPECT_NEAR(up_newton(), -1, 1e-6);
  run(0.3);
  EXPECT_LT(std::abs(up_newton()), 0.2);

  ASSERT_TRUE(push(-1));
  loop_.controls().is_estop_healthy = false;
  run(0.1);
  EXPECT_EQ(up_newton(), 0);
  EXPECT_FALSE(loop_.arm().session().steady_force().is_held()) << "cleared, it does not push again";
}

// All within one look of the daemon's at it.
TEST_F(SteadyForceCommands, EndsWithItsLeaseThoughThatIsTakenAgainAtOnce) {
  activate();
  ASSERT_TRUE(push(-1));
  run(0.1);
  std::optional<Result<api::Done>> told;
  sut_.deactivate("right", kHer, keep(told));
  EXPECT_FALSE(loop_.arm().session().steady_force().is_held());
  sut_.activate("right", kHer, keep(told));
  run(1);
  EXPECT_EQ(loop_.frame().state, OperatingState::Active);
  EXPECT_LT(std::abs(up_newton()), 0.2);
}

TEST_F(SteadyForceCommands, EndsWithAFaultThatIsClearedAtOnce) {
  activate();
  ASSERT_TRUE(push(-1));
  run(0.1);
  loop_.controls().is_estop_healthy = false;
  loop_.tick();
  loop_.controls().is_estop_healthy = true;
  loop_.tick();
  std::optional<Result<api::Done>> told;
  sut_.clear_fault("right", {}, kHer, keep(told));
  EXPECT_FALSE(loop_.arm().session().steady_force().is_held());
  run(1);
  EXPECT_LT(std::abs(up_newton()), 0.2);
}

TEST_F(SteadyForceCommands, EndsWhereNobodyLooksAfterItAnyMore) {
  activate();
  ASSERT_TRUE(push(-1));
  run(0.5);
  EXPECT_NEAR(up_newton(), -1, 1e-6);
  loop_.run(0.24);
  EXPECT_NEAR(up_newton(), -1, 1e-6);
  loop_.run(0.1);
  EXPECT_LT(std::abs(up_newton()), 0.2);
  run(1);
  EXPECT_LT(std::abs(up_newton()), 0.2) << "once let go of it does not come back";
}

}  // namespace
}  // namespace thimble
