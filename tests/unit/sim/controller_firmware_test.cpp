#include "sim/model/arm/controller_firmware.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/unit/sim/usb_frames.hpp"

namespace thimble::sim {
namespace {

constexpr Duration kMs{1'000'000};

class ControllerFirmwareTest : public testing::Test {
 protected:
  ControllerFirmwareTest() {
    sut.power_up(at(0), Duration{0}, totals);
    sut.run_until(at(0), totals);
  }

  static MonotonicTime at(std::int64_t ms) { return {ms * kMs}; }
  // Brings the board to `ms` and exchanges as the bus does in the frame that begins there.
  std::optional<Fields> frame(std::int64_t ms, std::optional<Fields> out = std::nullopt) {
    sut.run_until(at(ms), totals);
    if (out.has_value()) sut.out_report(at(ms), bytes_of(*out));
    std::array<std::uint8_t, 64> in{};
    return sut.in_report(at(ms), in) == 14 ? std::optional(fields_of(in)) : std::nullopt;
  }
  [[nodiscard]] double current_a(std::size_t motor) const {
    return sut.amplifier().current_a()[motor];
  }

  ControllerFirmware sut{{.amplifier_max_a = 3}};
  EncoderTotals totals{100, -200, 300, 0, 0, 0};
};

TEST_F(ControllerFirmwareTest, StartsFromZeroWhateverThePose) {
  EXPECT_EQ(frame(1), (Fields{0, 0, 0, 0, 0, 0, 0}));
  totals = {105, -207, 300, 0, 0, 0};
  frame(2, currents(0, 0, 0));
  EXPECT_EQ(frame(3), (Fields{5, -7, 0, 0, 0, 0, 0}));
}

TEST_F(ControllerFirmwareTest, SaysOneReportAndThenWaitsWithoutEnd) {
  EXPECT_TRUE(frame(1).has_value());
  for (int ms = 2; ms < 2000; ++ms) ASSERT_FALSE(frame(ms).has_value()) << ms;
  EXPECT_EQ(sut.state(), ControllerFirmware::State::Waiting);
  // What starts the exchange again after 10 ms without an answer is the host's zero report.
  EXPECT_FALSE(frame(2000, Fields{}).has_value());
  EXPECT_TRUE(frame(2001).has_value());
  EXPECT_FALSE(frame(2002).has_value());
}

TEST_F(ControllerFirmwareTest, AnswersEveryFrameWhenSpokenToInEveryFrame) {
  for (int ms = 1; ms <= 1000; ++ms) ASSERT_TRUE(frame(ms, Fields{}).has_value()) << ms;
  EXPECT_EQ(sut.counters().reports_sent, 1000U);
  EXPECT_EQ(sut.counters().reports_handled, 999U);
}

TEST_F(ControllerFirmwareTest, AnswersWithTheCountersOfTheFrameBefore) {
  frame(1);
  frame(2, Fields{});
  totals[0] += 10;
  sut.run_until(at(3), totals);  // handles the report and takes its snapshot here
  totals[0] += 10;
  EXPECT_EQ(frame(4)->at(0), 10);
}

TEST_F(ControllerFirmwareTest, DrainsToTheNewestReport) {
  // The host takes nothing for two frames, so the board is stuck in sending.
  sut.run_until(at(1), totals);
  sut.out_report(at(1), bytes_of(currents(1000, 0, 0)));
  sut.run_until(at(2), totals);
  sut.out_report(at(2), bytes_of(currents(2000, 0, 0)));
  sut.run_until(at(5), totals);
  EXPECT_EQ(current_a(0), 0) << "nothing is handled before the report went out";
  EXPECT_TRUE(frame(5).has_value());

  sut.run_until(at(6), totals);

  EXPECT_NEAR(current_a(0), 2, 1e-3);
  EXPECT_EQ(sut.counters().superseded, 1U);
  EXPECT_EQ(sut.counters().reports_handled, 1U);
}

TEST_F(ControllerFirmwareTest, MovesNoMotorBeforeTheFrameAfterTheReport) {
  frame(1);
  frame(10, currents(1500, -1500, 750));
  sut.run_until({Duration(11 * kMs) - Duration(1)}, totals);
  EXPECT_FALSE(sut.amplifier().is_on());
  EXPECT_EQ(current_a(0), 0);

  sut.run_until(at(11), totals);

  EXPECT_TRUE(sut.amplifier().is_on());
  EXPECT_NEAR(current_a(0), 1.5, 1e-3);
  EXPECT_NEAR(current_a(1), -1.5, 1e-3);
  EXPECT_NEAR(current_a(2), 0.75, 1e-3);
}

TEST_F(ControllerFirmwareTest, WatchdogSwitchesOffHalfASecondAfterTheLastReportToTheNanosecond) {
  frame(1, currents(1000, 0, 0));
  frame(9);
  frame(10, currents(1000, 0, 0));  // handled at 11 ms
  sut.run_until({Duration(511 * kMs) - Duration(1)}, totals);
  EXPECT_TRUE(sut.amplifier().is_on());
  EXPECT_NEAR(current_a(0), 1, 1e-3);

  sut.run_until(at(511), totals);

  EXPECT_FALSE(sut.amplifier().is_on());
  EXPECT_EQ(current_a(0), 0);
  EXPECT_EQ(sut.counters().watchdog_trips, 1U);
}

TEST_F(ControllerFirmwareTest, WatchdogRunsWhileTheBoardIsStuckInSending) {
  frame(1);
  frame(2, currents(1000, 0, 0));
  sut.run_until(at(3), totals);
  ASSERT_EQ(sut.state(), ControllerFirmware::State::Sending);
  ASSERT_TRUE(sut.amplifier().is_on());

  sut.run_until(at(600), totals);

  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST_F(ControllerFirmwareTest, NextReportEnablesAfterTheWatchdogAndNoOldCurrentReturns) {
  frame(1, currents(2000, 0, 0));
  frame(700);
  ASSERT_FALSE(sut.amplifier().is_on());
  frame(700, currents(500, 0, 0));

  sut.run_until(at(701), totals);

  EXPECT_TRUE(sut.amplifier().is_on());
  EXPECT_NEAR(current_a(0), 0.5, 1e-3);
  EXPECT_EQ(sut.counters().watchdog_trips, 1U);
}

TEST_F(ControllerFirmwareTest, DoesNotTripBeforeTheFirstReport) {
  sut.run_until(at(5000), totals);

  EXPECT_EQ(sut.counters().watchdog_trips, 0U);
  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST_F(ControllerFirmwareTest, SetsItsCountersAndDropsTheCurrents) {
  frame(1, currents(1000, 1000, 1000));
  frame(2, Fields{11, -22, 33, 1, 4000, -5000, 32767});

  const std::optional<Fields> answer = frame(3);

  EXPECT_EQ(answer, (Fields{4000, -5000, 32767, 11, -22, 33, 0}));
  EXPECT_EQ(current_a(0), 0);
  EXPECT_TRUE(sut.amplifier().is_on());
  totals[0] -= 1;
  frame(4, Fields{});
  EXPECT_EQ(frame(5)->at(0), 3999);
}

TEST_F(ControllerFirmwareTest, CountersWrapAsSixteenBit) {
  frame(1, set_counters(32767, -32768, 0));
  frame(2);
  totals[0] += 1;
  totals[1] -= 1;
  totals[2] += 65536 + 5;
  frame(3, Fields{});

  EXPECT_EQ(frame(4), (Fields{-32768, 32767, 5, 0, 0, 0, 0}));
}

TEST_F(ControllerFirmwareTest, FlagsTheCalibrationButtonUntilTheNextSet) {
  sut.set_calibration_button(true);
  sut.set_calibration_button(false);
  frame(1, Fields{});
  EXPECT_EQ(frame(2, Fields{})->at(6), 1) << "kept after release";
  EXPECT_EQ(frame(3, set_counters(1, 2, 3))->at(6), 1);
  EXPECT_EQ(frame(4, Fields{})->at(6), 0);
}

TEST_F(ControllerFirmwareTest, HeldButtonDoesNotFlagAgainAfterASet) {
  sut.set_calibration_button(true);
  frame(1, set_counters(0, 0, 0));
  frame(2, Fields{});
  sut.set_calibration_button(true);
  EXPECT_EQ(frame(3, Fields{})->at(6), 0);
  sut.set_calibration_button(false);
  sut.set_calibration_button(true);
  EXPECT_EQ(frame(4, Fields{})->at(6), 1);
}

TEST_F(ControllerFirmwareTest, TakesAnUnknownCommandAsCurrentsAndCountsIt) {
  frame(1, Fields{1000, 0, 0, 77, 5, 5, 5});

  EXPECT_EQ(frame(2), (Fields{0, 0, 0, 0, 0, 0, 0}));
  EXPECT_NEAR(current_a(0), 1, 1e-3);
  EXPECT_EQ(sut.counters().unknown_command, 1U);
}

TEST_F(ControllerFirmwareTest, ReportOfWrongLengthIsAnsweredButMovesNothing) {
  frame(1);
  for (const std::size_t size : {0U, 1U, 13U, 15U, 64U, 200U}) {
    const std::vector<std::uint8_t> bytes(size, 0x11);
    const std::int64_t ms = 10 + static_cast<std::int64_t>(size);
    sut.out_report(at(ms), bytes);
    EXPECT_TRUE(frame(ms + 1).has_value()) << size;
    EXPECT_FALSE(sut.amplifier().is_on()) << size;
  }
  EXPECT_EQ(sut.counters().wrong_length, 6U);
  EXPECT_EQ(sut.counters().reports_handled, 0U);
}

TEST_F(ControllerFirmwareTest, WrongLengthDoesNotFeedTheWatchdog) {
  frame(1, currents(1000, 0, 0));
  for (int ms = 2; ms <= 600; ++ms) {
    sut.run_until(at(ms), totals);
    sut.out_report(at(ms), std::array<std::uint8_t, 13>{});
    std::array<std::uint8_t, 64> in{};
    sut.in_report(at(ms), in);
  }
  EXPECT_EQ(sut.counters().watchdog_trips, 1U);
  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST_F(ControllerFirmwareTest, BootsSilentlyAndForgetsEverything) {
  frame(1, set_counters(9, 9, 9));
  frame(2, currents(1000, 0, 0));
  frame(3);
  sut.set_calibration_button(true);
  sut.power_up(at(10), 1000 * kMs, totals);
  EXPECT_FALSE(sut.amplifier().is_on());
  sut.set_calibration_button(false);
  sut.set_calibration_button(true);
  totals[0] += 50;  // before the encoders are watched
  EXPECT_FALSE(frame(11, currents(1000, 0, 0)).has_value());
  EXPECT_FALSE(frame(1009).has_value());

  EXPECT_EQ(frame(1010), (Fields{}));
  EXPECT_EQ(sut.counters().sent_while_off, 1U);
  frame(1011, Fields{});
  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST(TeensyFirmware, TakesAndSendsReportsOf64BytesOnly) {
  ControllerFirmware sut({.amplifier_max_a = 3, .is_teensy = true});
  const EncoderTotals totals{};
  sut.power_up({}, Duration{0}, totals);
  std::array<std::uint8_t, 64> in{};
  std::int64_t ms = 1;
  const auto frame_of = [&](std::size_t size) {
    const MonotonicTime t{(ms++) * kMs};
    sut.run_until(t, totals);
    std::array<std::uint8_t, 64> out{};
    out[0] = 100;  // mA
    sut.out_report(t, {out.data(), size});
    return sut.in_report(t, in);
  };
  EXPECT_EQ(frame_of(14), 64U);
  EXPECT_EQ(frame_of(64), 64U);
  EXPECT_EQ(sut.counters().wrong_length, 1U);
  EXPECT_EQ(sut.counters().reports_handled, 0U);
  frame_of(64);
  EXPECT_EQ(sut.counters().reports_handled, 1U);
  EXPECT_TRUE(sut.amplifier().is_on());
  sut.run_until({ms * kMs}, totals);
  EXPECT_EQ(sut.in_report({ms * kMs}, {in.data(), 63}), 0U);
}

TEST_F(ControllerFirmwareTest, RefusesAHostBufferThatIsTooShort) {
  std::array<std::uint8_t, 13> in{};
  sut.run_until(at(1), totals);
  EXPECT_EQ(sut.in_report(at(1), in), 0U);
  EXPECT_TRUE(frame(2).has_value());
}

TEST_F(ControllerFirmwareTest, GarbageNeverDrivesBeyondFullScaleNorStopsTheExchange) {
  std::mt19937 generator(5);
  std::array<std::uint8_t, 300> bytes{};
  for (int ms = 1; ms < 20'000; ++ms) {
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(generator());
    const std::size_t size = generator() % 3 == 0 ? generator() % bytes.size() : 14;
    sut.run_until(at(ms), totals);
    for (std::size_t motor = 0; motor < 3; ++motor) ASSERT_LE(std::abs(current_a(motor)), 3);
    std::array<std::uint8_t, 64> in{};
    ASSERT_EQ(sut.in_report(at(ms), in), 14U);
    sut.out_report(at(ms), {bytes.data(), size});
  }
  const FirmwareCounters seen = sut.counters();
  EXPECT_GT(seen.wrong_length, 1000U);
  EXPECT_GT(seen.saturations, 1000U);
  EXPECT_EQ(seen.wrong_length + seen.reports_handled + 1, seen.reports_sent);
}

TEST(MotorAmplifier, FollowsTheDutyLawWithinItsQuantum) {
  MotorAmplifier sut(3, Duration{0});
  sut.power_up({});
  sut.enable();
  for (int ma = -3000; ma <= 3000; ma += 7) {
    sut.write_current({}, {ma * 1e-3, 0, 0});
    sut.run_until({});
    EXPECT_NEAR(sut.current_a()[0], ma * 1e-3, 0.5 * 3 / (0.4 * 48000) + 1e-12);
  }
  EXPECT_EQ(sut.saturations(), 0U);
}

TEST(MotorAmplifier, SaturatesAtFullScaleEachMotorByItself) {
  MotorAmplifier sut(3, Duration{0});
  sut.power_up({});
  sut.enable();
  sut.write_current({}, {32.767, -32.768, 3.001});
  sut.run_until({});
  EXPECT_EQ(sut.current_a(), (std::array<double, 3>{3, -3, 3}));
  EXPECT_EQ(sut.saturations(), 3U);
}

TEST(MotorAmplifier, TakesANewDutyAtTheNextPwmPeriod) {
  MotorAmplifier sut(3, Duration{200'000});
  sut.power_up({Duration{0}});
  sut.enable();
  sut.write_current({Duration{1'000'000}}, {1, 0, 0});  // periods start at 0.2, 0.7, 1.2 ms …
  sut.run_until({Duration{1'199'999}});
  EXPECT_EQ(sut.current_a()[0], 0);
  sut.run_until({Duration{1'200'000}});
  EXPECT_NEAR(sut.current_a()[0], 1, 1e-3);
}

TEST(MotorAmplifier, EnableLineActsAtOnce) {
  MotorAmplifier sut(3, Duration{0});
  sut.power_up({});
  sut.enable();
  sut.write_current({}, {1, 1, 1});
  sut.run_until({});
  sut.disable();
  EXPECT_EQ(sut.current_a(), (std::array<double, 3>{}));
  sut.enable();
  EXPECT_EQ(sut.current_a(), (std::array<double, 3>{})) << "the duty went neutral";
}

}  // namespace
}  // namespace thimble::sim
