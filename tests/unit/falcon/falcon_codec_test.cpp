#include "drivers/falcon/falcon_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/falcon/run_packet_oracle.hpp"

namespace thimble::falcon {
namespace {

using test::Bytes;

std::vector<RunReport> parse_all(RunParser& sut, const Bytes& bytes) {
  std::vector<RunReport> found;
  for (const std::uint8_t byte : bytes) {
    if (const auto report = sut.take(byte)) found.push_back(*report);
  }
  return found;
}

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

std::string text_of(const RunPacket& packet) { return {packet.begin(), packet.end()}; }

RunReport report_of(std::array<std::int16_t, 3> counts, std::uint8_t buttons, std::uint8_t homed) {
  return {.encoder_counts = counts, .buttons = buttons, .homed = homed};
}

// By hand: 0x1234 is E D C B, -1 is four P, 2 is C A A A; flags 0x75 is 'A' + 117.
TEST(FalconCodec, ParsesAReportWrittenByHand) {
  Bytes bytes = bytes_of("<EDCBPPPPCAAA?Z>");
  bytes[13] = 0x41 + 0x75;
  RunParser sut;
  const auto found = parse_all(sut, bytes);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], report_of({0x1234, -1, 2}, wire::kButtonRight | wire::kButtonCentre, 0x70));
  EXPECT_TRUE(found[0].is_homed());
  EXPECT_EQ(sut.lost_bytes(), 0U);
}

TEST(FalconCodec, TwoHomedEncodersAreNotAll) {
  for (const std::uint8_t missing : wire::kHomed) {
    RunParser sut;
    const auto found = parse_all(sut, test::report_bytes({0, 0, 0}, wire::kAllHomed - missing));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_FALSE(found[0].is_homed());
  }
}

TEST(FalconCodec, AnIdleCommandIsWhatTheSheetSays) {
  EXPECT_EQ(text_of(encode_run_command({})), "<AAAAAAAAAAAAAA>");
}

TEST(FalconCodec, CommandsCarryMotorsHomingAndLights) {
  RunCommand command;
  command.motor_counts = {0x0123, -1, 4095};
  command.is_homing = true;
  command.lights.is_green = true;
  EXPECT_EQ(text_of(encode_run_command(command)), "<DCBAPPPPPPPADA>");
  command.is_homing = false;
  command.lights = {.is_red = true, .is_green = false, .is_blue = true};
  EXPECT_EQ(encode_run_command(command)[wire::kFlagsByte], 0x41 + 0x08 + 0x04);
}

TEST(FalconCodec, CommandsAreHeldWithinWhatTheFirmwareIsKnownToTake) {
  const RunPacket most = encode_run_command({.motor_counts = {4096, 32767, 4095}});
  const RunPacket least = encode_run_command({.motor_counts = {-4096, -32768, -4095}});
  EXPECT_EQ(most, encode_run_command({.motor_counts = {4095, 4095, 4095}}));
  EXPECT_EQ(least, encode_run_command({.motor_counts = {-4095, -4095, -4095}}));
}

// What is told has the form of what is heard, so the oracle of one direction reads the other.
TEST(FalconCodec, EveryCommandReadsAsItWasMeant) {
  for (int value = -4095; value <= 4095; ++value) {
    const auto counts = static_cast<std::int16_t>(value);
    const auto opposite = static_cast<std::int16_t>(-value);
    const RunPacket packet = encode_run_command({.motor_counts = {counts, opposite, 0}});
    const auto read = test::reports_in({packet.begin(), packet.end()});
    ASSERT_EQ(read.size(), 1U);
    ASSERT_EQ(read[0].encoder_counts, (std::array<std::int16_t, 3>{counts, opposite, 0}));
  }
}

TEST(FalconCodec, ModemStatusIsNoData) {
  const Bytes packet{0x01, 0x60, 'x', 'y'};
  const auto payload = serial_bytes(packet);
  EXPECT_EQ(Bytes(payload.begin(), payload.end()), bytes_of("xy"));
  for (const std::size_t size : {0U, 1U, 2U}) {
    EXPECT_TRUE(serial_bytes(std::span(packet).first(size)).empty()) << size;
  }
}

TEST(RunParser, AShortReportCostsItselfOnly) {
  RunParser sut;
  Bytes stream = test::report_bytes({1, 2, 3}, 0);
  stream.erase(stream.begin() + 5, stream.begin() + 7);
  const Bytes whole = test::report_bytes({4, 5, 6}, 1);
  stream.insert(stream.end(), whole.begin(), whole.end());
  const auto found = parse_all(sut, stream);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], report_of({4, 5, 6}, 1, 0));
  EXPECT_EQ(sut.lost_bytes(), 14U);
}

// The byte of unknown meaning may be anything, brackets among it.
TEST(RunParser, AnyUnknownByteIsTaken) {
  RunParser sut;
  for (int unknown = 0; unknown < 256; ++unknown) {
    const auto found =
        parse_all(sut, test::report_bytes({7, 8, 9}, 0, static_cast<std::uint8_t>(unknown)));
    ASSERT_EQ(found.size(), 1U) << unknown;
  }
  EXPECT_EQ(sut.lost_bytes(), 0U);
}

TEST(RunParser, ARefusedByteAtEachPlaceRefusesTheReport) {
  for (std::size_t place = 0; place < wire::kRunBytes; ++place) {
    if (place == wire::kUnknownByte) continue;
    RunParser sut;
    Bytes bytes = test::report_bytes({1, 2, 3}, 0);
    bytes[place] = '@';  // one below 'A', and no bracket
    EXPECT_TRUE(parse_all(sut, bytes).empty()) << place;
    EXPECT_EQ(parse_all(sut, test::report_bytes({1, 2, 3}, 0)).size(), 1U) << place;
  }
}

TEST(RunParser, ForgetsTheBeginningOfAReport) {
  RunParser sut;
  const Bytes whole = test::report_bytes({1, 2, 3}, 0);
  parse_all(sut, {whole.begin(), whole.begin() + 9});
  sut.forget();
  EXPECT_TRUE(parse_all(sut, {whole.begin() + 9, whole.end()}).empty());
  EXPECT_EQ(parse_all(sut, whole).size(), 1U);
}

// One step of a random stream: a whole report, a part of one, a glued beginning, or noise from the
// letters that reports are made of.
Bytes any_piece(std::mt19937& random) {
  Bytes piece = test::any_report(random);
  const int kind = test::between(random, 0, 5);
  if (kind <= 2) return piece;
  if (kind == 3) {
    const auto gone = static_cast<std::ptrdiff_t>(test::between(random, 0, 15));
    piece.erase(piece.begin() + gone);
    return piece;
  }
  if (kind == 4) {
    piece.resize(static_cast<std::size_t>(test::between(random, 0, 15)));
    return piece;
  }
  piece.resize(static_cast<std::size_t>(test::between(random, 0, 40)));
  constexpr std::string_view kLetters = "<<<>>ABCPQ@";
  for (std::uint8_t& byte : piece) {
    byte = static_cast<std::uint8_t>(kLetters[static_cast<std::size_t>(
        test::between(random, 0, static_cast<int>(kLetters.size()) - 1))]);
  }
  return piece;
}

// Byte by byte and with 16 bytes of memory it finds what a look at the whole stream finds, and what
// it has not reported it counts as lost, but for the beginning that it still holds.
TEST(RunParser, FindsInAnyStreamWhatALookAtTheWholeFinds) {
  std::mt19937 random(11);
  for (int round = 0; round < 3000; ++round) {
    Bytes stream;
    for (int pieces = test::between(random, 1, 12); pieces > 0; --pieces) {
      const Bytes piece = any_piece(random);
      stream.insert(stream.end(), piece.begin(), piece.end());
    }
    RunParser sut;
    const auto found = parse_all(sut, stream);
    ASSERT_EQ(found, test::reports_in(stream)) << round;
    const std::uint64_t used = sut.lost_bytes() + found.size() * wire::kRunBytes;
    ASSERT_LE(used, stream.size());
    ASSERT_LT(stream.size() - used, wire::kRunBytes);
  }
}

TEST(RunParser, AnyBytesAreJudgedAsALookAtTheWholeJudgesThem) {
  std::mt19937 random(12);
  for (int round = 0; round < 300; ++round) {
    Bytes stream(400);
    for (std::uint8_t& byte : stream) {
      byte = static_cast<std::uint8_t>(test::between(random, 0, 255));
    }
    RunParser sut;
    ASSERT_EQ(parse_all(sut, stream), test::reports_in(stream));
  }
}

}  // namespace
}  // namespace thimble::falcon
