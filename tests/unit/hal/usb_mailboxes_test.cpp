#include "hal/bus/usb_mailboxes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <random>
#include <thread>

#include "hal/bus/hid_mailboxes.hpp"

namespace thimble::bus {
namespace {

constexpr std::uint8_t kIn = 0x81;
constexpr std::uint8_t kOut = 0x02;
constexpr std::size_t kInPipe = 0;
constexpr std::size_t kOutPipe = 1;

std::vector<UsbOpenPipe> pipes(UsbDelivery delivery) {
  return {{{kIn, delivery}, {0, kIn, UsbTransferKind::Bulk, 64, 0}},
          {{kOut, UsbDelivery::Newest}, {0, kOut, UsbTransferKind::Bulk, 64, 0}}};
}

std::array<std::uint8_t, 8> bytes_of(std::uint64_t number) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(number & 0xffU);
    number >>= 8U;
  }
  return bytes;
}

std::uint64_t number_of(std::span<const std::uint8_t> bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) number = number << 8U | bytes[i];
  return number;
}

TEST(UsbMailboxes, AnEndThatNobodyAwaitsIsIgnored) {
  UsbMailboxes sut(pipes(UsbDelivery::Every));
  sut.finish_out(kOutPipe, UsbOutcome::Done, 16);
  sut.finish_out(kInPipe, UsbOutcome::Done, 16);
  sut.finish_in(kOutPipe, UsbOutcome::Done, {}, {});
  sut.finish_control({});
  EXPECT_EQ(sut.counters(kOut), UsbCounters{});
  EXPECT_EQ(sut.counters(0), UsbCounters{});
  UsbControlReply reply;
  EXPECT_EQ(sut.read_control(reply), IoStatus::NoData);
}

TEST(UsbMailboxes, APacketOfWhichTheDeviceTookAPartIsOutAndCut) {
  UsbMailboxes sut(pipes(UsbDelivery::Every));
  sut.submit(kOut, bytes_of(1));
  EXPECT_EQ(sut.take_out(kOutPipe).size(), 8U);
  sut.finish_out(kOutPipe, UsbOutcome::Done, 5);
  EXPECT_EQ(sut.counters(kOut).packets_out, 1U);
  EXPECT_EQ(sut.counters(kOut).writes_cut, 1U);
}

// Random ends: a submit is Ok exactly when nothing was owed, or a packet has reached the device
// whole since the submit before.
TEST(UsbMailboxes, ASubmitIsOkExactlyWhenTheWayOutMoves) {
  std::mt19937 random(7);
  UsbMailboxes sut(pipes(UsbDelivery::Every));
  std::uint64_t submitted = 0;
  std::uint64_t arrived = 0;
  std::uint64_t arrived_before = 0;
  for (int step = 0; step < 20000; ++step) {
    if (random() % 2 == 0) {
      const bool is_moving = arrived == submitted || arrived != arrived_before;
      arrived_before = arrived;
      const IoStatus expected = is_moving ? IoStatus::Ok : IoStatus::Backlogged;
      ASSERT_EQ(sut.submit(kOut, bytes_of(++submitted)), expected) << step;
      continue;
    }
    const auto packet = sut.take_out(kOutPipe);
    if (packet.empty() || random() % 4 == 0) continue;
    const auto outcome = static_cast<UsbOutcome>(random() % 4);
    const std::size_t taken = random() % 3 == 0 ? 5 : packet.size();
    if (outcome == UsbOutcome::Done && taken == packet.size()) arrived = number_of(packet);
    sut.finish_out(kOutPipe, outcome, taken);
  }
  EXPECT_GT(arrived, 100U);
}

// Random offers and ends of a queue against a plain one: each packet has one end, the oldest first.
TEST(UsbMailboxes, SeveralPacketsOfAQueueAreOfferedAtOnceAndEndOneAfterTheOther) {
  std::mt19937 random(9);
  auto both = pipes(UsbDelivery::Every);
  both[kOutPipe].pipe.delivery = UsbDelivery::Every;
  UsbMailboxes sut(both);
  std::deque<std::uint64_t> waiting;
  std::size_t offered = 0;
  std::uint64_t submitted = 0;
  std::uint64_t ended = 0;
  for (int step = 0; step < 20000; ++step) {
    const auto choice = random() % 5;
    if (choice < 2) {
      const bool fits = waiting.size() < kUsbQueuedPackets;
      const IoStatus status = sut.submit(kOut, bytes_of(submitted + 1));
      ASSERT_EQ(status, fits ? IoStatus::Ok : IoStatus::Backlogged);
      if (fits) waiting.push_back(++submitted);
    } else if (choice < 4) {
      const std::size_t nth = random() % (kUsbQueuedPackets + 2);
      const auto packet = sut.take_out(kOutPipe, nth);
      ASSERT_EQ(packet.empty(), nth >= waiting.size());
      if (packet.empty()) continue;
      ASSERT_EQ(number_of(packet), waiting[nth]);
      offered = std::max(offered, nth + 1);
    } else {
      sut.finish_out(kOutPipe, UsbOutcome::Done, 8);
      if (offered == 0) continue;  // nobody awaits it
      --offered;
      waiting.pop_front();
      ++ended;
    }
    ASSERT_EQ(sut.counters(kOut).packets_out, ended);
  }
  EXPECT_GT(ended, 2000U);
  EXPECT_EQ(sut.counters(kOut).writes_superseded, 0U);
}

// What the status calls superseded_commands.
TEST(HidMailboxes, OfABlockedWriteEveryCommandThatANewerOneReplacesIsCountedOnceItEnds) {
  HidMailboxes sut(8);
  EXPECT_EQ(sut.submit(bytes_of(1)), IoStatus::Ok);
  ASSERT_EQ(number_of(sut.take_out()), 1U);  // and the kernel keeps it
  for (std::uint64_t tick = 2; tick <= 20; ++tick) {
    EXPECT_EQ(sut.submit(bytes_of(tick)), IoStatus::Backlogged);
  }
  EXPECT_EQ(sut.counters().writes_superseded, 0U);
  sut.finish_out(true);
  EXPECT_EQ(number_of(sut.take_out()), 20U);
  EXPECT_EQ(sut.counters().writes_superseded, 18U);
  EXPECT_EQ(sut.counters().writes_failed, 0U);
}

TEST(UsbMailboxes, OfAMailboxThereIsNoSecondPacket) {
  UsbMailboxes sut(pipes(UsbDelivery::Newest));
  sut.submit(kOut, bytes_of(1));
  sut.submit(kOut, bytes_of(2));
  EXPECT_TRUE(sut.take_out(kOutPipe, 1).empty());
  EXPECT_EQ(number_of(sut.take_out(kOutPipe)), 2U);
  EXPECT_TRUE(sut.take_out(kOutPipe, 1).empty());
}

// As a report on a real bus: it leaves in the frame after it was written, so at a servo's rate of
// the frames' there is always one under way.
TEST(UsbMailboxes, AWayOutThatTakesOneAndAHalfTicksIsNoBacklog) {
  UsbMailboxes sut(pipes(UsbDelivery::Newest));
  std::uint64_t submitted = 0;
  sut.submit(kOut, bytes_of(++submitted));
  ASSERT_FALSE(sut.take_out(kOutPipe).empty());
  for (int tick = 0; tick < 100; ++tick) {
    // Half a tick before the next submit the first of two has arrived, and the other goes.
    const IoStatus status = sut.submit(kOut, bytes_of(++submitted));
    EXPECT_EQ(status, tick == 0 ? IoStatus::Backlogged : IoStatus::Ok) << tick;
    sut.finish_out(kOutPipe, UsbOutcome::Done, 8);
    ASSERT_FALSE(sut.take_out(kOutPipe).empty());
  }
}

TEST(UsbMailboxes, APacketLongerThanAnyIsCutToWhatCanBeKept) {
  UsbMailboxes sut(pipes(UsbDelivery::Newest));
  const std::vector<std::uint8_t> too_long(kMaxUsbPacketBytes + 100, 7);
  sut.finish_in(kInPipe, UsbOutcome::Done, too_long, {});
  UsbPacket packet;
  ASSERT_EQ(sut.read(kIn, packet), IoStatus::Ok);
  EXPECT_EQ(packet.size, kMaxUsbPacketBytes);
}

TEST(UsbMailboxes, BadEndsOfInputDeliverNothing) {
  UsbMailboxes sut(pipes(UsbDelivery::Every));
  sut.finish_in(kInPipe, UsbOutcome::Stalled, bytes_of(1), {});
  sut.finish_in(kInPipe, UsbOutcome::Babbled, bytes_of(1), {});
  sut.finish_in(kInPipe, UsbOutcome::Failed, bytes_of(1), {});
  UsbPacket packet;
  EXPECT_EQ(sut.read(kIn, packet), IoStatus::NoData);
  EXPECT_EQ(sut.counters(kIn), (UsbCounters{.stalls = 1, .babbles = 1, .failures = 1}));
}

TEST(UsbClaims, PacketsThatCannotBeKeptAreRefused) {
  UsbClaim claim;
  claim.pipes.push_back({kIn, UsbDelivery::Every});
  for (const std::uint16_t bytes : {std::uint16_t{0}, std::uint16_t{513}, std::uint16_t{65535}}) {
    const std::array<UsbEndpointInfo, 1> endpoints{{{0, kIn, UsbTransferKind::Bulk, bytes, 0}}};
    const auto pipes = resolve_claim(claim, endpoints);
    ASSERT_FALSE(pipes.has_value()) << bytes;
    EXPECT_NE(pipes.error().message.find("0x81"), std::string::npos) << pipes.error().message;
  }
}

TEST(UsbClaims, PipesComeInTheOrderOfTheClaim) {
  UsbClaim claim;
  claim.pipes.push_back({kOut, UsbDelivery::Newest});
  claim.pipes.push_back({kIn, UsbDelivery::Every});
  const std::array<UsbEndpointInfo, 2> endpoints{
      {{0, kIn, UsbTransferKind::Bulk, 64, 0}, {0, kOut, UsbTransferKind::Bulk, 32, 0}}};
  const auto resolved = resolve_claim(claim, endpoints).value();
  ASSERT_EQ(resolved.size(), 2U);
  EXPECT_EQ(resolved[0].info.max_packet_bytes, 32);
  EXPECT_EQ(resolved[1].pipe.delivery, UsbDelivery::Every);
}

// Both sides at once, as fast as they can: what arrives is whole, in order and counted.
TEST(UsbMailboxes, TwoThreadsExchangeWithoutTearingOrMiscounting) {
  UsbMailboxes sut(pipes(UsbDelivery::Every));
  constexpr std::uint64_t kExchanges = 20000;
  std::atomic<bool> is_over{false};
  std::uint64_t taken = 0;
  std::thread bus([&] {
    std::uint64_t last = 0;
    std::uint64_t sent = 0;
    while (!is_over.load() || !sut.take_out(kOutPipe).empty()) {
      if (const auto packet = sut.take_out(kOutPipe); !packet.empty()) {
        const std::uint64_t number = number_of(packet);
        EXPECT_GT(number, last);
        last = number;
        ++taken;
        sut.finish_out(kOutPipe, UsbOutcome::Done, packet.size());
      }
      ++sent;
      sut.finish_in(kInPipe, UsbOutcome::Done, bytes_of(sent), {});
      if (sut.take_control() != nullptr) sut.finish_control({});
    }
  });
  std::uint64_t read = 0;
  UsbPacket packet;
  UsbControlReply reply;
  for (std::uint64_t i = 1; i <= kExchanges; ++i) {
    sut.submit(kOut, bytes_of(i));
    sut.start_control({});
    sut.read_control(reply);
    if (sut.read(kIn, packet) != IoStatus::Ok) continue;
    ++read;
    ASSERT_EQ(number_of(packet.payload()), packet.sequence);
  }
  is_over.store(true);
  bus.join();
  while (sut.read(kIn, packet) == IoStatus::Ok) ++read;

  const UsbCounters out = sut.counters(kOut);
  EXPECT_EQ(out.packets_out, taken);
  EXPECT_EQ(out.packets_out + out.writes_superseded, kExchanges);
  EXPECT_LE(read + sut.counters(kIn).packets_skipped, sut.counters(kIn).packets_in);
}

}  // namespace
}  // namespace thimble::bus
