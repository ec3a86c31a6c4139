#include "sim/model/falcon/falcon_firmware.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>

namespace thimble::sim {
namespace {

class FalconFirmwareTest : public testing::Test {
 protected:
  std::string tell(std::string_view bytes) {
    std::string out;
    for (const char byte : bytes) {
      for (const std::uint8_t sent : sut.take(static_cast<std::uint8_t>(byte), cranks)) {
        out.push_back(static_cast<char>(sent));
      }
    }
    return out;
  }
  static int flags(std::string_view reply) { return static_cast<std::uint8_t>(reply.at(13)) - 'A'; }
  CrankCounts cranks{};
  FalconFirmware sut;
};

constexpr std::string_view kIdle = "<AAAAAAAAAAAAAA>";
constexpr std::string_view kHoming = "<AAAAAAAAAAAABA>";

TEST_F(FalconFirmwareTest, AnswersARequestWithItsEncodersLowestNibbleFirst) {
  sut.start(cranks);
  cranks = {0x1234, -1, 7};
  EXPECT_EQ(tell(kIdle), "<EDCBPPPPHAAAAA>");
  cranks = {0x12345, -0x8001, 0};
  EXPECT_EQ(tell(kIdle), "<FEDCPPPHAAAAAA>") << "16 bits, which wrap";
}

TEST_F(FalconFirmwareTest, TakesMotorCommandsLowestNibbleFirst) {
  sut.start(cranks);
  EXPECT_EQ(tell("<DCBAPPPPAAABAA"), "") << "15 bytes";
  EXPECT_EQ(sut.motor_counts(), (std::array<int, 3>{}));
  EXPECT_EQ(tell(">").size(), 16U);
  EXPECT_EQ(sut.motor_counts(), (std::array<int, 3>{0x0123, -1, 0x1000 - 1}))
      << "0x1000 is clamped";
  tell("<AAAAAAAAABAAA?>");
  EXPECT_EQ(sut.motor_counts(), (std::array<int, 3>{0, 0, 0x0010})) << "byte 14 may be anything";
}

TEST_F(FalconFirmwareTest, ClampsMotorCommands) {
  sut.start(cranks);
  tell("<PPPHAAAIPPPAAA>");
  EXPECT_EQ(sut.motor_counts(), (std::array<int, 3>{4095, -4095, 4095}));
  EXPECT_EQ(sut.counters().clamped, 2U);
}

TEST_F(FalconFirmwareTest, TheLastCommandHoldsForEver) {
  sut.start(cranks);
  tell("<BAAAAAAAAAAAAA>");
  for (int i = 0; i < 1000; ++i) tell("no request");
  EXPECT_EQ(sut.motor_counts()[0], 1);
}

TEST_F(FalconFirmwareTest, CountsFromWhereItStartedUntilACrankPassesHome) {
  cranks = {300, -20, 5};
  sut.start(cranks);
  EXPECT_EQ(tell(kIdle), kIdle);
  cranks = {0, -25, 5};
  sut.pass_home(0);
  EXPECT_EQ(tell(kIdle), "<ENOPLPPPAAAAAA>") << "not asked to: -300, -5, 0";
  tell(kHoming);
  sut.pass_home(0);
  sut.pass_home(1);
  EXPECT_EQ(tell(kHoming), "<AAAAHOPPAAAAqA>") << "0, -25, 0, and the bits of 1 and 2";
  sut.pass_home(2);
  EXPECT_EQ(flags(tell(kHoming)), 0x70);
  EXPECT_EQ(flags(tell(kIdle)), 0) << "told only while it is homing";
  EXPECT_EQ(flags(tell(kHoming)), 0x70);
  EXPECT_EQ(sut.counters().forces_before_homed, 0U);
}

TEST_F(FalconFirmwareTest, TellsTheButtonsAndTakesTheLamps) {
  sut.start(cranks);
  sut.set_buttons(0x15);
  EXPECT_EQ(flags(tell("<AAAAAAAAAAAAOA>")), 0x05);
  EXPECT_EQ(sut.lamps(), 0x07);
  EXPECT_FALSE(sut.is_homing());
  tell("<AAAAAAAAAAAAQA>");
  EXPECT_EQ(sut.counters().unknown_flags, 1U);
}

TEST_F(FalconFirmwareTest, CountsForceThatIsAskedForBeforeItIsHomed) {
  sut.start(cranks);
  tell("<BAAAAAAAAAAAAA>");
  EXPECT_EQ(sut.counters().forces_before_homed, 1U);
}

TEST_F(FalconFirmwareTest, DropsWhatIsBrokenAndFindsTheNext) {
  sut.start(cranks);
  const std::string cut(kIdle.substr(0, 14));
  EXPECT_EQ(tell(cut + std::string(kIdle)), kIdle) << "a short one, then a whole one";
  EXPECT_EQ(tell("<AAAA<" + std::string(kIdle)), kIdle);
  EXPECT_EQ(tell("<AAAAAAAAAAQAAA>" + std::string(kIdle)), kIdle) << "Q is no nibble";
  EXPECT_EQ(tell("AAAA>" + std::string(kIdle)), kIdle);
  EXPECT_EQ(sut.counters().requests, 4U);
  EXPECT_EQ(sut.counters().broken, 4U);
}

TEST_F(FalconFirmwareTest, SpoilsRepliesOnDemand) {
  sut.start(cranks);
  sut.set_faults({.short_every = 2, .glue_every = 0});
  EXPECT_EQ(tell(kIdle).size(), 16U);
  EXPECT_EQ(tell(kIdle), kIdle.substr(0, 14));
  sut.set_faults({.short_every = 0, .glue_every = 3});
  EXPECT_EQ(tell(kIdle), "");
  EXPECT_EQ(tell(kIdle), std::string(kIdle) + std::string(kIdle));
  EXPECT_EQ(tell(kIdle), kIdle);
}

// Against an oracle that looks for whole requests in the text, left to right.
TEST_F(FalconFirmwareTest, AnswersExactlyTheRequestsThatARandomTextContains) {
  std::mt19937 random(3);
  sut.start(cranks);
  std::string text;
  for (int piece = 0; piece < 3000; ++piece) {
    std::string request(kIdle);
    for (std::size_t i = 1; i < 13; ++i) request[i] = static_cast<char>('A' + random() % 16);
    if (random() % 4 == 0) request.resize(random() % 17);
    if (random() % 8 == 0) request[random() % 12] = static_cast<char>(random() % 127);
    text += request;
  }
  std::uint64_t expected = 0;
  for (std::size_t at = 0; at + 16 <= text.size();) {
    const bool is_whole =
        text[at] == '<' && text[at + 15] == '>' && text[at + 13] >= 'A' &&
        text.substr(at + 1, 12).find_first_not_of("ABCDEFGHIJKLMNOP") == std::string::npos;
    expected += is_whole ? 1U : 0U;
    at += is_whole ? 16 : 1;
  }
  const std::string replies = tell(text);
  EXPECT_EQ(sut.counters().requests, expected);
  EXPECT_EQ(replies.size(), 16 * expected);
  EXPECT_GT(expected, 1000U);
}

}  // namespace
}  // namespace thimble::sim
