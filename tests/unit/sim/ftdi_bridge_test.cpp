#include "sim/model/falcon/ftdi_bridge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace thimble::sim {
namespace {

using plugin::UsbHandshake;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

TEST(SerialLine, AByteOfOneSpeedArrivesAsItWasSentAndNotAtAnother) {
  for (unsigned value = 0; value < 256; ++value) {
    const SerialByte byte{static_cast<std::uint8_t>(value), 100'000};
    for (const double baud : {95'500.0, 100'000.0, 104'500.0}) {
      const ReceivedByte received = receive_at(byte, baud);
      EXPECT_EQ(received.value, value) << baud;
      EXPECT_TRUE(received.has_stop_bit);
    }
  }
  EXPECT_NE(receive_at({0x41, 9600}, 142'857).value, 0x41);
  EXPECT_FALSE(receive_at({0x41, 9600}, 142'857).has_stop_bit) << "still within the start bit";
  EXPECT_EQ(receive_at({0x00, 1.5e6}, 9600).value, 0xff) << "over before the first look";
  EXPECT_FALSE(receive_at({0x41, 9600}, 0).has_stop_bit);
}

TEST(SerialLine, BytesFollowEachOtherTenBitsApart) {
  SerialSender<3> sut;
  sut.set_speed(1e6);
  EXPECT_EQ(sut.next_arrival(), kNeverInTime);
  const MonotonicTime start{microseconds(7)};
  for (std::uint8_t value = 1; value <= 4; ++value) EXPECT_TRUE(sut.push(start, value));
  EXPECT_FALSE(sut.push(start, 5)) << "one shifts, three wait";
  for (int i = 1; i <= 4; ++i) {
    EXPECT_EQ(sut.next_arrival(), start + i * microseconds(10));
    EXPECT_EQ(sut.take_arrived().value, i);
  }
  EXPECT_TRUE(sut.is_idle());
  EXPECT_TRUE(sut.push(start + milliseconds(1), 9));
  EXPECT_EQ(sut.next_arrival(), start + milliseconds(1) + microseconds(10));
}

TEST(FtdiBaud, IsThreeMegahertzByADivisorWithEighths) {
  EXPECT_DOUBLE_EQ(ftdi_baud(0x4138), 9600);
  EXPECT_NEAR(ftdi_baud(0x0015), 142'857, 0.2);
  EXPECT_DOUBLE_EQ(ftdi_baud(0x0002), 1.5e6);
  EXPECT_DOUBLE_EQ(ftdi_baud(0), 3e6);
  EXPECT_DOUBLE_EQ(ftdi_baud(1), 2e6);
  EXPECT_DOUBLE_EQ(ftdi_baud(0x1c002), 3e6 / 2.875);
  for (std::uint32_t divisor = 0; divisor < 0x40000U; divisor += 97) {
    EXPECT_GT(ftdi_baud(divisor), 180);
    EXPECT_LE(ftdi_baud(divisor), 3e6);
  }
}

class FtdiBridgeTest : public testing::Test {
 protected:
  FtdiBridgeTest() { sut.power_up(now); }

  UsbHandshake set(std::uint8_t request, std::uint16_t value, std::uint16_t index = 0) {
    return sut.control(now, {.request = request, .value = value, .index = index}, {}).handshake;
  }
  void at_ms(double ms) { now = {from_seconds(ms * 1e-3)}; }
  void receive(const Bytes& bytes) {
    for (const std::uint8_t byte : bytes) sut.receive({byte, sut.speed_baud()});
  }
  // Without the status; nothing: the bridge said NAK.
  std::optional<Bytes> fetch() {
    std::array<std::uint8_t, 64> in{};
    const plugin::UsbAnswer answer = sut.in_packet(now, in);
    if (answer.handshake != UsbHandshake::Ack) return std::nullopt;
    status = Bytes(in.begin(), in.begin() + 2);
    return Bytes(in.begin() + 2, in.begin() + static_cast<std::ptrdiff_t>(answer.size));
  }
  // What arrives at the far end of the line.
  Bytes arrived() {
    Bytes all;
    while (sut.next_arrival() != kNeverInTime) all.push_back(sut.take_arrived().value);
    return all;
  }

  FtdiBridge sut;
  MonotonicTime now{};
  Bytes status;
};

TEST_F(FtdiBridgeTest, SaysNothingBeforeTheLatencyTimerAndThenTheStatusAlone) {
  at_ms(15.9);
  EXPECT_EQ(fetch(), std::nullopt);
  at_ms(16);
  EXPECT_EQ(fetch(), Bytes{});
  EXPECT_THAT(status, ElementsAre(0x01, 0x60));
  EXPECT_EQ(fetch(), std::nullopt);
  at_ms(32);
  EXPECT_EQ(fetch(), Bytes{});
  EXPECT_EQ(sut.counters().status_packets, 2U);
}

TEST_F(FtdiBridgeTest, HoldsAFewBytesBackUntilTheLatencyTimer) {
  set(9, 1);
  receive({1, 2, 3});
  at_ms(0.875);
  EXPECT_EQ(fetch(), std::nullopt);
  at_ms(1);
  EXPECT_EQ(fetch(), (Bytes{1, 2, 3}));
}

TEST_F(FtdiBridgeTest, OneThatInsistsKeepsItsLatencyWhateverItIsToldAndWithoutPower) {
  const auto told = [&] {
    std::array<std::uint8_t, 1> in{};
    const auto answer = sut.control(
        now, {.request_type = 0xc0, .request = 10, .value = 0, .index = 0, .length = 1}, in);
    EXPECT_EQ(answer.handshake, UsbHandshake::Ack);
    return in[0];
  };
  sut.insist_on_latency(milliseconds(16));
  EXPECT_EQ(set(9, 1), UsbHandshake::Ack);
  EXPECT_EQ(told(), 16) << "it says what it does";
  receive({1});
  at_ms(15);
  EXPECT_EQ(fetch(), std::nullopt);
  at_ms(16);
  EXPECT_EQ(fetch(), Bytes{1});
  at_ms(17);
  EXPECT_EQ(fetch(), std::nullopt);
  sut.insist_on_latency({});
  EXPECT_EQ(told(), 1) << "as it was told meanwhile";
  sut.insist_on_latency(milliseconds(9));
  sut.power_up(now);
  EXPECT_EQ(told(), 9);
}

TEST_F(FtdiBridgeTest, AFullPacketGoesAtOnce) {
  receive(Bytes(61, 7));
  EXPECT_EQ(fetch(), std::nullopt);
  receive(Bytes(100, 8));
  EXPECT_EQ(fetch()->size(), 62U);
  EXPECT_EQ(fetch()->size(), 62U);
  EXPECT_EQ(fetch(), std::nullopt) << "37 are left";
  at_ms(16);
  EXPECT_EQ(fetch()->size(), 37U);
}

TEST_F(FtdiBridgeTest, WhatComesInWhenItIsFullIsLostAndSaid) {
  receive(Bytes(300, 1));
  EXPECT_EQ(sut.counters().overruns, 44U);
  EXPECT_EQ(fetch()->size(), 62U);
  EXPECT_EQ(status[1] & 0x02, 0x02);
  EXPECT_EQ(fetch()->size(), 62U);
  EXPECT_EQ(status[1] & 0x02, 0);
}

TEST_F(FtdiBridgeTest, WhatTheHostWritesLeavesByteByByteAndPutsItOffWhenFull) {
  set(3, 0x0015);
  const Bytes packet(64, 0x55);
  EXPECT_EQ(sut.out_packet(now, packet), UsbHandshake::Ack);
  EXPECT_EQ(sut.out_packet(now, packet), UsbHandshake::Ack);
  EXPECT_EQ(sut.out_packet(now, packet), UsbHandshake::Nak);
  EXPECT_EQ(sut.next_arrival(), now + microseconds(70));
  EXPECT_EQ(arrived().size(), 128U);
  EXPECT_EQ(sut.counters().host_packets_nak, 1U);
}

TEST_F(FtdiBridgeTest, PurgesTheSideThatIsNamed) {
  const Bytes packet{1, 2, 3};
  sut.out_packet(now, packet);
  receive({9});
  set(0, 1);
  EXPECT_THAT(arrived(), ElementsAre(1)) << "what shifts goes on";
  at_ms(16);
  EXPECT_EQ(fetch(), Bytes{9});
  sut.out_packet(now, packet);
  receive({9});
  set(0, 2);
  EXPECT_THAT(arrived(), ElementsAre(1, 2, 3));
  at_ms(32);
  EXPECT_EQ(fetch(), Bytes{});
}

TEST_F(FtdiBridgeTest, MovesTheModemLinesThatAreMeantAndDropsThemOnReset) {
  set(1, 0x0101);
  EXPECT_TRUE(sut.is_dtr_high());
  set(1, 0x0202);
  EXPECT_TRUE(sut.is_dtr_high());
  EXPECT_TRUE(sut.is_rts_high());
  set(1, 0x0100);
  EXPECT_FALSE(sut.is_dtr_high());
  EXPECT_TRUE(sut.is_rts_high());
  set(3, 2);
  set(0, 0);
  EXPECT_FALSE(sut.is_rts_high());
  EXPECT_DOUBLE_EQ(sut.speed_baud(), 1.5e6) << "a reset leaves the speed";
}

TEST_F(FtdiBridgeTest, BytesOfAnotherSpeedAreGarbageAndSaid) {
  sut.receive({0x41, 142'857});
  at_ms(16);
  EXPECT_NE(fetch(), Bytes{0x41});
  sut.receive({0x00, 4800});
  EXPECT_EQ(sut.counters().framing_errors, 1U);
  at_ms(32);
  fetch();
  EXPECT_EQ(status[1] & 0x08, 0x08);
}

TEST_F(FtdiBridgeTest, InAnotherFormatBothDirectionsAreGarbage) {
  set(4, 0x0107);
  receive({0x41});
  sut.out_packet(now, Bytes{0x41});
  EXPECT_THAT(arrived(), ElementsAre(0xbe));
  at_ms(16);
  EXPECT_EQ(fetch(), Bytes{0xbe});
}

TEST_F(FtdiBridgeTest, TellsItsLatencyAndStallsWhatItDoesNotKnow) {
  std::array<std::uint8_t, 2> in{};
  set(9, 3);
  EXPECT_EQ(sut.control(now, {.request_type = 0xc0, .request = 10, .length = 1}, in).size, 1U);
  EXPECT_EQ(in[0], 3);
  set(9, 0);
  EXPECT_EQ(sut.latency(), milliseconds(1));
  EXPECT_EQ(set(0x90, 0), UsbHandshake::Stall);
  EXPECT_EQ(sut.control(now, {.request_type = 0x21, .request = 0}, {}).handshake,
            UsbHandshake::Stall);
  EXPECT_EQ(sut.counters().refused_requests, 2U);
}

// Against what is simple: bytes come out in their order, none twice, all that were not counted
// lost.
TEST_F(FtdiBridgeTest, KeepsEveryByteInOrderWhateverIsAskedWhen) {
  std::mt19937 random(7);
  Bytes sent;
  Bytes got;
  for (int round = 0; round < 20'000; ++round) {
    at_ms(0.125 * round);
    const Bytes burst(random() % 9, static_cast<std::uint8_t>(random()));
    const std::uint64_t lost = sut.counters().overruns;
    receive(burst);
    sent.insert(sent.end(), burst.begin(),
                burst.end() - static_cast<std::ptrdiff_t>(sut.counters().overruns - lost));
    if (random() % 5 == 0) set(9, static_cast<std::uint16_t>(1 + random() % 20));
    if (random() % 3 != 0) continue;
    while (const auto packet = fetch()) {
      EXPECT_LE(packet->size(), 62U);
      got.insert(got.end(), packet->begin(), packet->end());
    }
  }
  at_ms(10'000);
  while (const auto packet = fetch()) got.insert(got.end(), packet->begin(), packet->end());
  EXPECT_EQ(got, sent);
  EXPECT_EQ(sut.counters().bytes_to_host, sent.size());
}

}  // namespace
}  // namespace thimble::sim
