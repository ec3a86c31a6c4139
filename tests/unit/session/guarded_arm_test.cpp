#include "daemon/session/guarded_arm.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace thimble::session {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class FakeDevice final : public HapticDevice {
 public:
  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override { return able; }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override { return ""; }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return {}; }
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override { return zero; }
  void forget_calibration() noexcept override {}
  IoStatus read(HapticState& /*out*/) noexcept override { return IoStatus::NoData; }
  IoStatus write(const LimitedWrench& /*wrench*/) noexcept override { return IoStatus::Ok; }

  HapticCapabilities able;
  std::optional<ZeroCommand> zero{ZeroCommand{.endpoint = 2}};
};

struct GuardScript {
  bool can_make{true};
  bool can_be_asked{true};
  bool answers{true};
  bool has_ended{false};
  int made{0};
  std::vector<std::string> asked;
};

class FakeGuard final : public devices::ArmGuard {
 public:
  explicit FakeGuard(GuardScript& script) : script_(script) {}
  [[nodiscard]] rt::Heartbeat& heartbeat() noexcept override { return heartbeat_; }
  Result<void> ask(const bus::DeviceAddress& address, const ZeroCommand& zero) override {
    script_.asked.push_back(address.text + ' ' + std::to_string(zero.endpoint));
    script_.has_ended = !script_.can_be_asked;
    if (!script_.can_be_asked) return fail(Errc::System, "it cannot be started");
    return {};
  }
  [[nodiscard]] Result<bool> is_watching() override {
    if (script_.has_ended) return fail(Errc::System, "it ended");
    return script_.answers;
  }

 private:
  GuardScript& script_;
  rt::Heartbeat heartbeat_;
};

class FakeGuards final : public devices::ArmGuards {
 public:
  explicit FakeGuards(GuardScript& script) : script_(script) {}
  Result<std::unique_ptr<devices::ArmGuard>> make() override {
    if (!script_.can_make) return fail(Errc::System, "no memory");
    ++script_.made;
    return std::make_unique<FakeGuard>(script_);
  }

 private:
  GuardScript& script_;
};

class GuardedArmTest : public testing::Test {
 protected:
  GuardedArmTest() {
    device_.able.peak_force_newton = 8;
    device_.able.device_watchdog = milliseconds(500);
  }
  static std::string refusal(const Result<void>& result) {
    return result ? "" : result.error().message;
  }
  MonotonicTime at(Duration since) const { return MonotonicTime{since}; }

  GuardScript script_;
  FakeGuards guards_{script_};
  servo::ServoControls controls_;
  FakeDevice device_;
  GuardedArm sut_{"arm 'right'", {"hid:42"}, &guards_, controls_};
};

TEST_F(GuardedArmTest, HasItsDeviceWatchedWithTheZeroOfItsDriver) {
  ASSERT_EQ(sut_.heartbeat(), nullptr);
  EXPECT_EQ(refusal(sut_.begin(device_)), "");
  EXPECT_EQ(script_.asked, (std::vector<std::string>{"hid:42 2"}));
  EXPECT_NE(sut_.heartbeat(), nullptr);
  EXPECT_TRUE(controls_.is_guarded);
}

TEST_F(GuardedArmTest, OneThatReturnsIsWatchedAnewOnTheSameHeartbeat) {
  ASSERT_TRUE(sut_.begin(device_));
  rt::Heartbeat* const heartbeat = sut_.heartbeat();
  ASSERT_TRUE(sut_.begin(device_));
  EXPECT_EQ(script_.asked.size(), 2U);
  EXPECT_EQ(script_.made, 1);
  EXPECT_EQ(sut_.heartbeat(), heartbeat);
}

TEST_F(GuardedArmTest, NeedsNoneWhoseOwnWatchdogIsAsQuick) {
  device_.able.device_watchdog = milliseconds(20);
  EXPECT_TRUE(sut_.begin(device_));
  EXPECT_EQ(script_.made, 0);
  device_.able.device_watchdog = milliseconds(21);
  EXPECT_TRUE(sut_.begin(device_));
  EXPECT_EQ(script_.made, 1);
}

TEST_F(GuardedArmTest, NeedsOneWhoseWatchdogIsUnknown) {
  device_.able.device_watchdog = {};
  EXPECT_TRUE(sut_.begin(device_));
  EXPECT_EQ(script_.made, 1);
}

TEST_F(GuardedArmTest, NeedsNoneThatCannotPushOrIsSimulated) {
  GuardedArm simulated("arm 'left'", {"sim:falcon"}, nullptr, controls_);
  EXPECT_TRUE(simulated.begin(device_));
  device_.able.is_actuated = false;
  EXPECT_TRUE(sut_.begin(device_));
  EXPECT_EQ(script_.made, 0);
  EXPECT_TRUE(controls_.is_guarded);
}

TEST_F(GuardedArmTest, IsRefusedWhereNoneCanBeHad) {
  GuardedArm alone("arm 'right'", {"usb:1-4"}, nullptr, controls_);
  EXPECT_EQ(refusal(alone.begin(device_)), "arm 'right' needs a guard, and this program has none");
  script_.can_make = false;
  EXPECT_EQ(refusal(sut_.begin(device_)), "arm 'right': guard: no memory");
  script_.can_make = true;
  script_.can_be_asked = false;
  EXPECT_EQ(refusal(sut_.begin(device_)), "arm 'right': guard: it cannot be started");
  EXPECT_FALSE(controls_.is_guarded);
  device_.zero.reset();
  EXPECT_EQ(refusal(sut_.begin(device_)),
            "arm 'right' needs a guard, but its driver does not say what takes its force away");
}

// Worlds are computed by the thread that would wait for it.
TEST_F(GuardedArmTest, IsNotWaitedForAndNothingIsDrivenBeforeItAnswers) {
  script_.answers = false;
  EXPECT_EQ(refusal(sut_.begin(device_)), "");
  EXPECT_FALSE(controls_.is_guarded);
  EXPECT_EQ(refusal(sut_.follow(at(seconds(9)))), "");
  EXPECT_EQ(refusal(sut_.follow(at(seconds(10)))), "");
  EXPECT_FALSE(controls_.is_guarded);
  script_.answers = true;
  EXPECT_EQ(refusal(sut_.follow(at(seconds(11)))), "");
  EXPECT_TRUE(controls_.is_guarded);
  EXPECT_EQ(script_.asked.size(), 1U);
}

TEST_F(GuardedArmTest, OneThatDoesNotAnswerIsToldOfAndReplaced) {
  script_.answers = false;
  ASSERT_TRUE(sut_.begin(device_));
  EXPECT_EQ(refusal(sut_.follow(at(seconds(1)))), "");
  const Duration late = seconds(1) + GuardedArm::kPatience;
  EXPECT_EQ(refusal(sut_.follow(at(late - milliseconds(1)))), "");
  EXPECT_EQ(refusal(sut_.follow(at(late))), "arm 'right': guard: it does not answer");
  EXPECT_EQ(script_.asked.size(), 1U);
  EXPECT_EQ(refusal(sut_.follow(at(late + milliseconds(1)))), "");
  EXPECT_EQ(script_.asked.size(), 2U);
  EXPECT_FALSE(controls_.is_guarded);
  script_.answers = true;
  EXPECT_EQ(refusal(sut_.follow(at(late + milliseconds(2)))), "");
  EXPECT_TRUE(controls_.is_guarded);
}

TEST_F(GuardedArmTest, OneThatEndsBeforeItsAnswerIsToldOfEachTime) {
  script_.answers = false;
  ASSERT_TRUE(sut_.begin(device_));
  int told = 0;
  for (int ms = 0; ms < 60'000; ms += 10) {
    script_.has_ended = true;
    told +=
        refusal(sut_.follow(at(seconds(1) + milliseconds(ms)))) == "arm 'right': guard: it ended";
  }
  EXPECT_EQ(told, static_cast<int>(script_.asked.size()));
  EXPECT_GT(told, 30);
  EXPECT_LT(told, 40);
  EXPECT_FALSE(controls_.is_guarded);
}

// An answer proves nothing: it is replaced as rarely as one that gives none, and each end is told.
TEST_F(GuardedArmTest, OneThatAnswersAndEndsAgainAndAgainIsToldOfEachTimeAndTriedLessAndLessOften) {
  ASSERT_TRUE(sut_.begin(device_));
  int told = 0;
  for (int ms = 0; ms < 60'000; ms += 10) {
    const MonotonicTime now = at(seconds(1) + milliseconds(ms));
    EXPECT_EQ(refusal(sut_.follow(now)), "");
    if (!controls_.is_guarded) continue;
    script_.has_ended = true;
    told += refusal(sut_.follow(now)) == "arm 'right': guard: it ended";
    EXPECT_FALSE(controls_.is_guarded);
  }
  EXPECT_EQ(told, static_cast<int>(script_.asked.size()));
  // The first, then at 0.01, 0.06, 0.16 … 3.16 s, and then every 2 s.
  EXPECT_EQ(script_.asked.size(), 1U + 7U + 28U);
}

TEST_F(GuardedArmTest, OneThatHasWatchedForLongIsReplacedSoonAgain) {
  ASSERT_TRUE(sut_.begin(device_));
  const auto end = [&](Duration when) {
    script_.has_ended = true;
    EXPECT_NE(refusal(sut_.follow(at(when))), "");
  };
  // How long after its end, at `when`, another one is asked, looked for every 10 ms.
  const auto ends_until_asked = [&](Duration when) {
    end(when);
    const std::size_t before = script_.asked.size();
    for (Duration rest{};; rest += milliseconds(10)) {
      EXPECT_EQ(refusal(sut_.follow(at(when + rest))), "");
      if (script_.asked.size() > before || rest > seconds(9)) return rest;
    }
  };
  Duration now = seconds(1);
  for (int i = 0; i < 8; ++i) now += ends_until_asked(now);
  EXPECT_EQ(ends_until_asked(now), seconds(2));
  now += seconds(2);
  EXPECT_EQ(refusal(sut_.follow(at(now))), "");
  now += GuardedArm::kProven;
  EXPECT_EQ(refusal(sut_.follow(at(now))), "");
  EXPECT_EQ(ends_until_asked(now), Duration::zero());
  EXPECT_EQ(ends_until_asked(now), milliseconds(50));
}

TEST_F(GuardedArmTest, AGuardThatEndsStopsTheArmAtOnceAndIsReplaced) {
  ASSERT_TRUE(sut_.begin(device_));
  EXPECT_EQ(refusal(sut_.follow(at(milliseconds(900)))), "");
  script_.has_ended = true;
  script_.can_be_asked = false;
  EXPECT_EQ(refusal(sut_.follow(at(seconds(1)))), "arm 'right': guard: it ended");
  EXPECT_FALSE(controls_.is_guarded);
  EXPECT_EQ(refusal(sut_.follow(at(seconds(1)))), "arm 'right': guard: it cannot be started");
  script_.can_be_asked = true;
  EXPECT_EQ(refusal(sut_.follow(at(seconds(1) + milliseconds(49)))), "");
  EXPECT_FALSE(controls_.is_guarded) << "the next try is due 50 ms after the last";
  EXPECT_EQ(refusal(sut_.follow(at(seconds(1) + milliseconds(50)))), "");
  EXPECT_TRUE(controls_.is_guarded);
  EXPECT_EQ(script_.asked.size(), 3U);
}

TEST_F(GuardedArmTest, AGuardThatCannotBeHadIsTriedLessAndLessOften) {
  ASSERT_TRUE(sut_.begin(device_));
  ASSERT_TRUE(sut_.follow(at(milliseconds(900))));
  script_.has_ended = true;
  script_.can_be_asked = false;
  EXPECT_FALSE(sut_.follow(at(seconds(1))));
  for (int ms = 0; ms < 60'000; ms += 10) (void)sut_.follow(at(seconds(1) + milliseconds(ms)));
  // At 0, 0.05, 0.15 … 3.15 s, and then every 2 s.
  EXPECT_EQ(script_.asked.size(), 1U + 7U + 28U);
}

}  // namespace
}  // namespace thimble::session
