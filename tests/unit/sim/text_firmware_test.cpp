#include "sim/model/arm/text_firmware.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "sim/model/arm/text_arm_model.hpp"

namespace thimble::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

struct TextFirmwareTest : testing::Test {
  TextFirmware sut{{.build_number = 3}};
  MonotonicTime now{};
  EncoderTotals totals{100, 200, 300};

  TextFirmwareTest() { sut.power_up(now, Duration(0), totals); }

  std::string said() {
    std::string text(600, '\0');
    text.resize(sut.give({reinterpret_cast<std::uint8_t*>(text.data()), text.size()}));
    return text;
  }
  // What it answers to `text`, which arrives at once.
  std::string ask(std::string_view text) {
    EXPECT_EQ(sut.take({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}),
              text.size());
    sut.run_until(now, totals);
    return said();
  }
  void pass(Duration duration) {
    now = now + duration;
    sut.run_until(now, totals);
  }
  double current_a(std::size_t motor = 0) const { return sut.amplifier().current_a()[motor]; }
};

TEST_F(TextFirmwareTest, SaysNothingUnaskedAndAnswersEachMessageOnce) {
  pass(milliseconds(50));
  EXPECT_EQ(said(), "");
  totals = {110, 180, 300};
  EXPECT_EQ(ask("[0,0,0]\n"), "[3,10,-20,0,0,0,0,0]\n");
  EXPECT_EQ(said(), "");
}

TEST_F(TextFirmwareTest, RefusesWhatTheSheetSaysItRefusesAndRepeatsTheLastCounters) {
  totals = {110, 200, 300};
  EXPECT_EQ(ask("[1,2,3]\n"), "[3,10,0,0,0,0,0,0]\n");
  totals = {150, 200, 300};
  EXPECT_EQ(ask("1,2,3]"), "[3,10,0,0,0,0,0,256]\n");
  EXPECT_EQ(ask("[1,2]"), "[3,10,0,0,0,0,0,512]\n");
  EXPECT_EQ(ask("[1,2,3,4]"), "[3,10,0,0,0,0,0,512]\n");
  EXPECT_EQ(ask("[a,b,c]"), "[3,10,0,0,0,0,0,1024]\n");
  EXPECT_EQ(ask("[1,2,3]x"), "[3,10,0,0,0,0,0,8]\n");
  EXPECT_EQ(ask(std::string(127, '0')), "[3,10,0,0,0,0,0,128]\n");
  EXPECT_EQ(sut.counters().messages_refused, 6U);
  EXPECT_EQ(ask(std::string("[1,2,3]\r\n\0\0", 11)), "[3,50,0,0,0,0,0,0]\n");
}

TEST_F(TextFirmwareTest, ThrowsAwayTwoMessagesThatItFindsTogether) {
  EXPECT_EQ(ask("[1000,0,0]\n[2000,0,0]\n").substr(0, 19), "[3,0,0,0,0,0,0,8]\n[");
  EXPECT_EQ(sut.counters().messages_taken, 0U);
  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST_F(TextFirmwareTest, OfTwoFoundTogetherItTakesTheNewerIfThatHasAByteToLose) {
  ask(" [1000,0,0]\n");
  pass(milliseconds(1));
  EXPECT_NEAR(current_a(), 1, 0.01);
  const std::string padding(5, '\0');
  EXPECT_EQ(ask(" [2000,0,0]\n" + padding + " [0,0,0]\n"),
            "[3,0,0,0,0,0,0,8]\n[3,0,0,0,0,0,0,0]\n");
  pass(milliseconds(1));
  EXPECT_NEAR(current_a(), 0, 0.01);
  EXPECT_TRUE(sut.amplifier().is_on());
  EXPECT_EQ(ask("[7,7,7 [1000,0,0]\n [0,0,0]\n").substr(0, 2), "[3") << "what went before is torn";
  pass(milliseconds(1));
  EXPECT_NEAR(current_a(), 0, 0.01);
}

TEST_F(TextFirmwareTest, ACurrentBeyondFullScaleIsNoCurrent) {
  ask("[6000,-6000,6001]");
  pass(milliseconds(1));
  EXPECT_NEAR(current_a(0), 6, 0.01);
  EXPECT_NEAR(current_a(1), -6, 0.01);
  EXPECT_NEAR(current_a(2), 0, 0.01);
  EXPECT_EQ(sut.counters().cut_to_zero, 1U);
}

TEST_F(TextFirmwareTest, TheWatchdogDropsTheEnableLineAndTheNextMessageRaisesIt) {
  ask("[1000,0,0]");
  pass(milliseconds(100) - microseconds(1));
  EXPECT_NEAR(current_a(), 1, 0.01);
  pass(microseconds(1));
  EXPECT_EQ(current_a(), 0);
  EXPECT_FALSE(sut.amplifier().is_on());
  EXPECT_EQ(sut.counters().watchdog_trips, 1U);
  ask("[1000,0,0]");
  pass(milliseconds(1));
  EXPECT_NEAR(current_a(), 1, 0.01);
}

TEST_F(TextFirmwareTest, ARefusedMessageFeedsNoWatchdog) {
  ask("[1000,0,0]");
  for (int i = 0; i < 10; ++i) {
    pass(milliseconds(10));
    ask("[1000,0]");
  }
  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST_F(TextFirmwareTest, TheButtonMakesTheCountersZeroAndSaysNothingOfIt) {
  totals = {500, 600, 700};
  sut.set_calibration_button(true);
  pass(milliseconds(1));
  EXPECT_EQ(ask("[0,0,0]"), "[3,0,0,0,0,0,0,0]\n");
  totals = {501, 600, 700};
  pass(milliseconds(1));
  EXPECT_EQ(ask("[0,0,0]"), "[3,1,0,0,0,0,0,0]\n") << "the edge, not the level";
}

TEST_F(TextFirmwareTest, ABuildThatWantsItsButtonMakesUpCountersAndDrivesNothing) {
  TextFirmware shy({.build_number = 2, .is_calibration_wanted = true});
  shy.power_up(now, Duration(0), totals);
  sut = shy;
  EXPECT_EQ(ask("[1234,5,6]"), "[2,8000,1234,0,0,0,0,0]\n");
  for (int i = 0; i < 2000; ++i) ask("[0,0,0]");
  EXPECT_NE(ask("[0,0,0]"), "[2,8000,0,0,0,0,0,0]\n");
  EXPECT_FALSE(sut.amplifier().is_on());
  sut.set_calibration_button(true);
  pass(milliseconds(1));
  EXPECT_EQ(ask("[1000,0,0]"), "[2,0,0,0,0,0,0,0]\n");
  EXPECT_TRUE(sut.amplifier().is_on());
}

TEST_F(TextFirmwareTest, AnswersThatNobodyReadsHoldTheLoopUpButNotTheWatchdog) {
  ask("[1000,0,0]");
  for (int i = 0; i < 100; ++i) {
    const std::string_view text = "[1000,0,0]";
    sut.take({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    sut.run_until(now, totals);
  }
  EXPECT_LT(sut.counters().messages_taken, 40U);
  pass(milliseconds(100));
  EXPECT_FALSE(sut.amplifier().is_on());
}

TEST_F(TextFirmwareTest, AnyBytesAreBorneAndNeverDriveBeyondFullScale) {
  std::mt19937 random(6);
  const std::string letters = "[],-0123456789\n";
  for (int i = 0; i < 20'000; ++i) {
    std::string text;
    while (text.size() < 20) text += letters[random() % letters.size()];
    ask(text);
    pass(milliseconds(1));
    ASSERT_LE(std::abs(current_a()), 6.01);
  }
}

TEST(TextArmModel, SaysWhatItIs) {
  plugin::SimModelRegistry models;
  register_text_arm_models(models);
  ASSERT_EQ(models.entries().size(), 3U);
  for (const plugin::SimModelEntry& entry : models.entries()) {
    const auto model = entry.create({});
    ASSERT_TRUE(model) << entry.name;
    const bus::BusDeviceInfo info = plugin::describe(*model);
    EXPECT_EQ(info.kind, bus::BusKind::Serial);
    EXPECT_EQ(info.vendor_id, 0x16C0);
    EXPECT_EQ(info.product_id, 0x0483);
    EXPECT_EQ(info.address.text, "sim:" + entry.name);
    EXPECT_NE(plugin::arm_backend(*model), nullptr);
    EXPECT_FALSE(entry.create({.amplifier_max_a = -1}));
    EXPECT_FALSE(entry.create({.amplifier_max_a = 33}));
  }
}

}  // namespace
}  // namespace thimble::sim
