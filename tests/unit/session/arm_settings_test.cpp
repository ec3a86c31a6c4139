#include "daemon/session/arm_settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <typeinfo>
#include <utility>
#include <vector>

#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/two_port_arm.hpp"
#include "daemon/servo/sample_freshness.hpp"

namespace thimble::session {
namespace {

constexpr double kDepth_m = 0.001;

HapticCapabilities arm_of(double max_stiffness_newton_per_m) {
  HapticCapabilities capabilities;
  capabilities.max_stiffness_newton_per_m = max_stiffness_newton_per_m;
  return capabilities;
}

// What a hand at rest feels that a wall let in by a millimetre before the first force.
double wall_newton(coupling::ArmCoupling& sut, double asked_newton_per_m) {
  using std::chrono::milliseconds;
  coupling::ConstraintSet set;
  set.sequence = set.session = 1;
  set.planes.push_back({{1, 0, 0}, 0.0, {.stiffness = Stiffness{asked_newton_per_m}}});
  MonotonicTime now{milliseconds(1)};
  sut.reset(now, {});
  coupling::ArmInput input{.now = now,
                           .dt = milliseconds(1),
                           .tip = {-kDepth_m, 0, 0},
                           .fresh = &set,
                           .link = {true, milliseconds(1), {}}};
  (void)sut.step(input);
  input.tip = {kDepth_m, 0, 0};
  input.fresh = nullptr;
  input.now = now + milliseconds(1);
  return -sut.step(input).force.x;
}

// A board on full-speed USB that answers what it hears, in milliseconds: a command leaves with the
// next frame, the answer comes in the one after. The servo's clock runs 20 ppm slow against the
// frames', and each of its ticks comes a little sooner or later.
class BeatingArm {
 public:
  explicit BeatingArm(std::uint64_t seed) : random_(seed) {}

  // Faults there are until `seconds` have passed, and how many exchanges were missed.
  std::pair<FaultCode, std::uint64_t> drive(const servo::ServoSettings& settings, double jitter_ms,
                                            int seconds) {
    servo::SampleFreshness sut(settings.freshness);
    const double period_ms = 1000 / settings.rate_hz;
    sut.restart(at(0));
    for (int tick = 1; tick * period_ms < 1000.0 * seconds; ++tick) {
      const double now_ms = tick * period_ms * (1 + 20e-6) + jitter_ms * noise_(random_);
      run_frames_until(now_ms);
      const bool is_fresh = take_answer(now_ms);
      if (waiting_since_ms_ < 0) waiting_since_ms_ = now_ms;
      if (newest_ms_ == 0) continue;  // it has answered nothing yet
      const auto verdict = sut.judge(at(now_ms), at(newest_ms_), is_fresh);
      if (verdict.fault != FaultCode::None) return {verdict.fault, sut.missed()};
    }
    return {FaultCode::None, sut.missed()};
  }

 private:
  static constexpr double kWithinFrame_ms = 0.05;

  static MonotonicTime at(double ms) { return MonotonicTime{from_seconds(1 + 1e-3 * ms)}; }
  void run_frames_until(double now_ms) {
    const double leaves_ms = std::ceil(std::max(waiting_since_ms_, busy_until_ms_));
    if (waiting_since_ms_ < 0 || leaves_ms > now_ms) return;
    waiting_since_ms_ = -1;
    busy_until_ms_ = leaves_ms + kWithinFrame_ms;
    answers_ms_.push_back(leaves_ms + 1 + kWithinFrame_ms);
  }
  bool take_answer(double now_ms) {
    bool is_fresh = false;
    while (!answers_ms_.empty() && answers_ms_.front() <= now_ms) {
      newest_ms_ = answers_ms_.front();
      answers_ms_.pop_front();
      is_fresh = true;
    }
    return is_fresh;
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> noise_;
  double waiting_since_ms_{-1};
  double busy_until_ms_{-1};
  double newest_ms_{0};
  std::deque<double> answers_ms_;
};

TEST(ServoSettings, AnArmWhoseFramesBeatAgainstTheServoMissesNothingAtAnyRate) {
  HapticCapabilities arm = arm_of(500);
  arm.is_actuated = false;
  arm.sample_period = std::chrono::milliseconds(1);
  for (const double rate_hz : {500.0, 1000.0, 2000.0, 4000.0, 8000.0}) {
    config::ServoConfig servo;
    servo.rate_hz = rate_hz;
    const auto settings = servo_settings({}, servo, arm);
    ASSERT_TRUE(settings.has_value()) << settings.error().message;
    for (const double jitter_ms : {0.002, 0.02, 0.1}) {
      for (std::uint64_t seed = 1; seed < 5; ++seed) {
        const auto [fault, missed] = BeatingArm(seed).drive(*settings, jitter_ms, 60);
        EXPECT_EQ(fault, FaultCode::None) << rate_hz << ' ' << jitter_ms << ' ' << seed;
        EXPECT_EQ(missed, 0U) << rate_hz << ' ' << jitter_ms << ' ' << seed;
      }
    }
  }
}

TEST(ServoSettings, HaveTheRateOfThePersonOrElseThatOfTheArm) {
  HapticCapabilities arm = arm_of(500);
  arm.is_actuated = false;
  config::ServoConfig servo;
  const auto rate_hz = [&] {
    const auto settings = servo_settings({}, servo, arm);
    return settings ? settings->rate_hz : 0;
  };
  EXPECT_EQ(rate_hz(), 1000);
  arm.full_rate_hz = 4000;
  EXPECT_EQ(rate_hz(), 4000);
  servo.rate_hz = 1000;
  EXPECT_EQ(rate_hz(), 1000);
  servo.rate_hz = 8000;
  EXPECT_EQ(rate_hz(), 8000);
}

TEST(MakeCoupling, LetsNoWorldAskForMoreThanTheArmCanRender) {
  const auto soft = make_coupling({}, 0, arm_of(500));
  const auto unknown = make_coupling({}, 0, arm_of(0));
  ASSERT_TRUE(soft && unknown);
  EXPECT_NEAR(wall_newton(**soft, 2000), 500 * kDepth_m, 1e-9);
  EXPECT_NEAR(wall_newton(**soft, 300), 300 * kDepth_m, 1e-9);
  EXPECT_NEAR(wall_newton(**unknown, 2000), 2000 * kDepth_m, 1e-9);
}

TEST(MakeCoupling, BringsItsOwnWallsDownToTheArm) {
  const auto sut = make_coupling({}, 0, arm_of(500));
  ASSERT_TRUE(sut);
  EXPECT_NEAR(wall_newton(**sut, -1), 500 * kDepth_m, 1e-9);
}

TEST(MakeCoupling, LeavesWhatAPersonConfigured) {
  config::ArmConfig arm;
  arm.coupling.stiffness_newton_per_m = 1500;
  const auto sut = make_coupling(arm, 0, arm_of(500));
  ASSERT_TRUE(sut);
  EXPECT_NEAR(wall_newton(**sut, -1), 1500 * kDepth_m, 1e-9);
}

TEST(MakeCoupling, PutsAGuardAroundAnySchemeThatIsToHaveOne) {
  for (const auto scheme :
       {config::CouplingScheme::GhostPoint, config::CouplingScheme::ThesisLiteral,
        config::CouplingScheme::RemoteForce, config::CouplingScheme::SpringDamper,
        config::CouplingScheme::Wave, config::CouplingScheme::ConstraintPlane,
        config::CouplingScheme::BufferZone, config::CouplingScheme::Composite}) {
    config::ArmConfig arm;
    arm.coupling.scheme = scheme;
    const auto bare = make_coupling(arm, 0, arm_of(500));
    arm.coupling.passivity.emplace();
    const auto guarded = make_coupling(arm, 0, arm_of(500));
    ASSERT_TRUE(bare && guarded);
    EXPECT_EQ(dynamic_cast<coupling::PassivityGuard*>(bare->get()), nullptr);
    const auto* guard = dynamic_cast<coupling::PassivityGuard*>(guarded->get());
    ASSERT_NE(guard, nullptr);
    const coupling::ArmCoupling& inside = guard->inside();
    const coupling::ArmCoupling& alone = **bare;
    EXPECT_EQ(typeid(inside), typeid(alone));
  }
}

TEST(MakeCoupling, PutsAMassBetweenTheHandAndTheSpringWhereOneIsSaid) {
  config::ArmConfig arm;
  arm.coupling.scheme = config::CouplingScheme::SpringDamper;
  const auto told_m = [&] {
    const auto sut = make_coupling(arm, 0, arm_of(500)).value();
    sut->reset({}, {});
    const coupling::ArmInput moved{.now = {std::chrono::milliseconds(1)},
                                   .dt = std::chrono::milliseconds(1),
                                   .tip = {0.001, 0, 0}};
    return sut->step(moved).sample.hand.x;
  };
  EXPECT_EQ(told_m(), 0.001) << "the hand is the master";
  arm.coupling.master_mass_kg = 0.1;
  EXPECT_LT(told_m(), 0.0005) << "the mass has yet to follow";
}

config::ArmConfig far_arm() {
  config::ArmConfig arm;
  arm.link = config::UdpEndpoint{"127.0.0.1", 5001};
  arm.protocol = config::LinkProtocol::Thimble;
  return arm;
}

TEST(MakeCoupling, LeavesTheSchemeToAWorldFarAwayWithAnArmHalfThatGoesWithBoth) {
  const config::ArmConfig arm = far_arm();
  ASSERT_TRUE(leaves_scheme_to_world(arm));
  const auto half = make_coupling(arm, 0, arm_of(500));
  ASSERT_TRUE(half);
  EXPECT_NE(dynamic_cast<coupling::CompositeArm*>(half->get()), nullptr);
  const auto asked = arm_end_settings(arm).value();
  EXPECT_EQ(asked.half.scheme.view(), "composite");
  ASSERT_TRUE(asked.else_half);
  EXPECT_EQ(asked.else_half->scheme.view(), "ghost-point");
}

TEST(MakeCoupling, AsksForNothingButWhatASchemeSaysOrAMapDoesNotGoWith) {
  std::vector<config::ArmConfig> arms(6, far_arm());
  arms[0].coupling.scheme = config::CouplingScheme::GhostPoint;
  arms[1].coupling.mode = config::CouplingMode::LockStep;
  arms[2].deadband_m = 0.001;
  arms[3].place_m = {0, 0, 0.1};
  arms[4].protocol = config::LinkProtocol::Thesis;
  arms[5].link.reset();
  for (const config::ArmConfig& arm : arms) {
    EXPECT_FALSE(leaves_scheme_to_world(arm));
    EXPECT_FALSE(arm_end_settings(arm).value().else_half);
    EXPECT_EQ(arm_end_settings(arm).value().half.scheme.view(), "ghost-point");
    const auto half = make_coupling(arm, 0, arm_of(500));
    ASSERT_TRUE(half);
    EXPECT_NE(dynamic_cast<coupling::GhostPointArm*>(half->get()), nullptr);
  }
}

TEST(MakeCoupling, PutsTheArmsEndOfAGuardBetweenBothEndsAroundARemoteForce) {
  config::ArmConfig arm;
  arm.coupling.scheme = config::CouplingScheme::RemoteForce;
  arm.coupling.passivity.emplace().is_two_port = true;
  const auto sut = make_coupling(arm, 0, arm_of(500));
  ASSERT_TRUE(sut);
  EXPECT_NE(dynamic_cast<coupling::TwoPortArm*>(sut->get()), nullptr);
}

}  // namespace
}  // namespace thimble::session
