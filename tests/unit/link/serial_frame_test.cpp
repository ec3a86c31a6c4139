#include "daemon/link/serial_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string_view>
#include <vector>

namespace thimble::link {
namespace {

using LineBytes = std::vector<std::byte>;

std::vector<LineBytes> datagrams_in(Deframer& sut, std::span<const std::byte> line) {
  std::vector<LineBytes> out;
  for (const std::byte byte : line) {
    if (const auto datagram = sut.push(byte)) out.emplace_back(datagram->begin(), datagram->end());
  }
  return out;
}

LineBytes noise(std::mt19937& random, std::size_t size, unsigned most = 255) {
  LineBytes out(size);
  for (std::byte& byte : out) byte = std::byte(random() % (most + 1));
  return out;
}

TEST(SerialFrame, HasTheChecksumOfTheBook) {
  constexpr std::string_view kCheck = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(kCheck))), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}

// Written by hand: 00 ff, its CRC-32 (zlib.crc32(b"\x00\xff") is 0x6cdbfd72), no zero left.
TEST(SerialFrame, MatchesTheBytesWrittenByHand) {
  const LineBytes datagram{std::byte{0x00}, std::byte{0xFF}};
  const LineBytes framed{std::byte{0x00}, std::byte{0x01}, std::byte{0x06},
                         std::byte{0xFF}, std::byte{0x6C}, std::byte{0xDB},
                         std::byte{0xFD}, std::byte{0x72}, std::byte{0x00}};
  const SerialFrame sut = frame(datagram);
  EXPECT_EQ(LineBytes(sut.view().begin(), sut.view().end()), framed);
}

TEST(SerialFrame, EveryDatagramComesBackHoweverItIsMadeOfZeros) {
  std::mt19937 random(1);
  for (std::size_t size = 1; size <= kMaxThimbleDatagram; size += size < 300 ? 1 : 37) {
    for (const unsigned most : {0U, 1U, 255U}) {
      const LineBytes datagram = noise(random, size, most);
      const SerialFrame framed = frame(datagram);
      EXPECT_LE(framed.size, kMaxSerialFrame);
      EXPECT_EQ(std::count(framed.view().begin(), framed.view().end(), std::byte{0}), 2);
      Deframer sut;
      const std::vector<LineBytes> out = datagrams_in(sut, framed.view());
      ASSERT_EQ(out.size(), 1U) << size;
      EXPECT_EQ(out[0], datagram);
    }
  }
  LineBytes full(kMaxThimbleDatagram, std::byte{1});  // no zero: a code byte each 254
  Deframer sut;
  EXPECT_EQ(datagrams_in(sut, frame(full).view()).at(0), full);
}

TEST(SerialFrame, NothingIsFramedThatCannotBe) {
  EXPECT_EQ(frame({}).size, 0U);
  EXPECT_EQ(frame(LineBytes(kMaxThimbleDatagram + 1)).size, 0U);
}

TEST(SerialFrame, NoSingleTurnedOrLostByteGivesAnotherDatagram) {
  std::mt19937 random(2);
  const LineBytes datagram = noise(random, 60);
  const SerialFrame good = frame(datagram);
  for (std::size_t at = 0; at < good.size; ++at) {
    for (unsigned bit = 0; bit <= 8; ++bit) {
      LineBytes line(good.view().begin(), good.view().end());
      if (bit == 8) {
        line.erase(line.begin() + static_cast<long>(at));
      } else {
        line[at] ^= std::byte(1U << bit);
      }
      line.insert(line.begin(), std::byte{0});
      line.push_back(std::byte{0});
      Deframer sut;
      for (const LineBytes& out : datagrams_in(sut, line))
        EXPECT_EQ(out, datagram) << at << " " << bit;
    }
  }
}

TEST(SerialFrame, IsInStepAgainAfterWhateverWasOnTheLine) {
  std::mt19937 random(3);
  for (int run = 0; run < 300; ++run) {
    Deframer sut;
    datagrams_in(sut, noise(random, random() % 5000, run % 2 == 0 ? 255 : 3));
    const LineBytes datagram = noise(random, 1 + random() % 100);
    const std::vector<LineBytes> out = datagrams_in(sut, frame(datagram).view());
    ASSERT_EQ(out.size(), 1U);
    EXPECT_EQ(out[0], datagram);
  }
}

TEST(SerialFrame, NoiseIsCountedAndNeverADatagram) {
  std::mt19937 random(4);
  Deframer sut;
  EXPECT_TRUE(datagrams_in(sut, noise(random, 1'000'000)).empty());
  EXPECT_GT(sut.counters().damaged, 3000U);
  EXPECT_EQ(sut.counters().frames, 0U);
}

TEST(SerialFrame, WhatNeverEndsIsCountedWhileItGoesOn) {
  Deframer sut;
  const LineBytes endless(3 * kMaxSerialFrame + 1, std::byte{0x55});
  EXPECT_TRUE(datagrams_in(sut, endless).empty());
  EXPECT_EQ(sut.counters().damaged, 3U);
  EXPECT_TRUE(datagrams_in(sut, LineBytes{std::byte{0}}).empty());
  EXPECT_EQ(sut.counters().damaged, 3U) << "its end is no further frame";
  EXPECT_EQ(datagrams_in(sut, frame(LineBytes{std::byte{7}}).view()).size(), 1U);
}

TEST(SerialFrame, ZerosThatCanBeNoEndAreCounted) {
  Deframer sut;
  const SerialFrame whole = frame(LineBytes{std::byte{7}});
  for (int i = 0; i < 3; ++i) EXPECT_EQ(datagrams_in(sut, whole.view()).size(), 1U);
  EXPECT_EQ(sut.counters().damaged, 0U) << "two of them are between two frames";
  EXPECT_TRUE(datagrams_in(sut, LineBytes(10)).empty());
  EXPECT_EQ(sut.counters().damaged, 9U);
  EXPECT_EQ(datagrams_in(sut, whole.view()).size(), 1U);
}

// What a read brings, so long after the one before.
struct LateReader {
  Deframer sut;
  MonotonicTime now{std::chrono::seconds(1)};

  std::size_t frames_in(std::span<const std::byte> bytes, Duration later) {
    now = now + later;
    sut.on_read(now);
    return datagrams_in(sut, bytes).size();
  }
};
constexpr Duration kLate = kLineSilence * 3 / 2;

TEST(SerialFrame, AReaderThatIsLateLosesNothing) {
  LateReader sut;
  const SerialFrame whole = frame(LineBytes{std::byte{7}, std::byte{8}});
  EXPECT_EQ(sut.frames_in(whole.view().first(4), kLate), 0U);
  LineBytes rest(whole.view().begin() + 4, whole.view().end());
  rest.insert(rest.end(), whole.view().begin(), whole.view().end());
  EXPECT_EQ(sut.frames_in(rest, kLate), 2U);
  EXPECT_EQ(sut.sut.counters().damaged, 0U);
  EXPECT_EQ(sut.frames_in(whole.view().first(4), kLate), 0U);
  EXPECT_EQ(sut.frames_in(rest, kLate), 2U) << "and not only once";
  EXPECT_EQ(sut.sut.counters().damaged, 0U);
}

TEST(SerialFrame, WhatTheLineFellSilentInIsCountedAndNotGoneOnWith) {
  LateReader sut;
  const SerialFrame whole = frame(LineBytes{std::byte{7}, std::byte{8}});
  EXPECT_EQ(sut.frames_in(whole.view().first(4), kLate), 0U);
  EXPECT_EQ(sut.frames_in(whole.view(), kLate), 1U);
  EXPECT_EQ(sut.sut.counters().damaged, 1U);
  EXPECT_EQ(sut.frames_in({}, kLate), 0U);
  EXPECT_EQ(sut.sut.counters().damaged, 1U) << "silence between frames is none";
}

// A receiver that is slower than the sender: an arm that hears no answer asks now and then.
TEST(SerialFrame, WhatHasNoEndAtTheSecondSilenceIsCounted) {
  LateReader sut;
  const LineBytes garbage(20, std::byte{0xE6});
  for (int i = 0; i < 6; ++i) EXPECT_EQ(sut.frames_in(garbage, kLate), 0U);
  EXPECT_EQ(sut.sut.counters().damaged, 2U);
  EXPECT_EQ(sut.frames_in({}, kLate), 0U);
  EXPECT_EQ(sut.sut.counters().damaged, 3U);
  EXPECT_EQ(sut.frames_in(frame(LineBytes{std::byte{7}}).view(), kLate), 1U);
  EXPECT_EQ(sut.sut.counters().damaged, 3U);
}

TEST(LinePaceTest, KeepsTheRateOfTheLine) {
  for (const std::uint32_t rate : {38'400U, 115'200U, 3'000'000U}) {
    LinePace sut(rate);
    MonotonicTime now{};
    std::size_t bytes = 0;
    while (now.since_epoch < std::chrono::seconds(1)) {
      sut.on_sent(48, now);
      bytes += 48;
      now = sut.free_at();
    }
    EXPECT_NEAR(static_cast<double>(bytes), rate / 10.0, 48);
  }
  LinePace sut(38'400);
  sut.on_sent(12, {});
  EXPECT_EQ(sut.free_at(),
            MonotonicTime{Duration(3'125'000)});  // 12 bytes: thesis 3.1.1 has 2.5 ms of 8 bits
}

}  // namespace
}  // namespace thimble::link
