#include "tests/contract/serial_port_contract.hpp"

#include <algorithm>
#include <random>

#include "hal/bus/usb_device.hpp"
#include "tests/contract/byte_pattern.hpp"

namespace thimble::test {
namespace {

using Bytes = SerialRig::Bytes;

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

// How many messages of one byte, the length of the rest, and that; fails the test when one is cut.
std::uint64_t whole_messages(const Bytes& received) {
  std::uint64_t messages = 0;
  for (std::size_t at = 0; at < received.size(); ++messages) {
    const std::size_t size = received[at++];
    const Bytes rest(received.begin() + static_cast<std::ptrdiff_t>(at), received.end());
    EXPECT_GE(rest.size(), size) << "cut";
    if (rest.size() < size) return messages;
    EXPECT_TRUE(std::equal(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size),
                           pattern(size, 0).begin()));
    at += size;
  }
  return messages;
}

}  // namespace

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SerialPortContract);

Bytes SerialPortContract::read_all() {
  Bytes all;
  bus::SerialChunk chunk;
  while (rig->port().read(chunk) == IoStatus::Ok) {
    EXPECT_GT(chunk.size, 0U);
    all.insert(all.end(), chunk.payload().begin(), chunk.payload().end());
  }
  return all;
}

TEST_P(SerialPortContract, NothingArrivedLeavesTheOutputUntouched) {
  run_ms(3);
  bus::SerialChunk chunk;
  chunk.sequence = 77;
  chunk.size = 3;
  EXPECT_EQ(rig->port().read(chunk), IoStatus::NoData);
  EXPECT_EQ(chunk.sequence, 77U);
  EXPECT_EQ(chunk.size, 3U);
  EXPECT_EQ(rig->port().counters(), bus::SerialCounters{});
}

TEST_P(SerialPortContract, OpeningSendsNothing) {
  run_ms(5);
  EXPECT_TRUE(rig->received_by_device().empty());
}

TEST_P(SerialPortContract, TheStreamArrivesInOrderAndOnce) {
  rig->device_sends(pattern(700, 1));
  run_ms(20);
  rig->device_sends(pattern(3, 9));
  run_ms(20);
  EXPECT_EQ(read_all(), pattern(700, 1) + pattern(3, 9));
  EXPECT_TRUE(read_all().empty());
  EXPECT_EQ(rig->port().counters().bytes_in, 703U);
  EXPECT_EQ(rig->port().counters().chunks_skipped, 0U);
}

// Neither end is a terminal: nothing is echoed, translated, cut or taken for a signal.
TEST_P(SerialPortContract, EveryByteIsThatByteBothWays) {
  const Bytes all = [] {
    Bytes bytes(256);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i);
    return bytes;
  }();
  rig->device_sends(all);
  EXPECT_EQ(rig->port().submit(all), IoStatus::Ok);
  run_ms(20);
  EXPECT_EQ(read_all(), all);
  EXPECT_EQ(rig->received_by_device(), all);
}

TEST_P(SerialPortContract, AFullQueueLosesTheNewerOnesAndTheGapShows) {
  constexpr std::size_t kTooMany = bus::kUsbQueuedPackets + 6;
  for (std::size_t i = 0; i < kTooMany; ++i) {
    rig->device_sends({static_cast<std::uint8_t>(i)});
    run_ms(1);
  }
  const Bytes read = read_all();
  ASSERT_EQ(read.size(), bus::kUsbQueuedPackets);
  EXPECT_EQ(read.back(), bus::kUsbQueuedPackets - 1);
  rig->device_sends({200});
  run_ms(3);
  bus::SerialChunk chunk;
  ASSERT_EQ(rig->port().read(chunk), IoStatus::Ok);
  EXPECT_EQ(chunk.sequence, kTooMany + 1);
  EXPECT_EQ(rig->port().counters().chunks_skipped, 6U);
}

TEST_P(SerialPortContract, AMessageOfAnyLengthReachesTheDeviceOnceOnly) {
  Bytes sent;
  std::uint64_t messages = 0;
  for (const std::size_t size : {1U, 2U, 16U, 63U, 64U, 65U, 128U, 511U, 512U}) {
    EXPECT_EQ(rig->port().submit(pattern(size, 3)), IoStatus::Ok) << size;
    run_ms(10);
    sent = sent + pattern(size, 3);
    ASSERT_EQ(rig->received_by_device(), sent) << size;
    EXPECT_EQ(rig->port().counters().messages_out, ++messages);
    EXPECT_EQ(rig->port().counters().bytes_out, sent.size());
  }
}

TEST_P(SerialPortContract, TheLatestOfSeveralSubmitsWinsAndEachIsCounted) {
  for (unsigned i = 1; i <= 4; ++i) {
    const IoStatus status = rig->port().submit(pattern(16, i));
    EXPECT_TRUE(status == IoStatus::Ok || status == IoStatus::Backlogged) << to_string(status);
  }
  run_ms(5);
  const Bytes received = rig->received_by_device();
  ASSERT_GE(received.size(), 16U);
  EXPECT_EQ(Bytes(received.end() - 16, received.end()), pattern(16, 4));
  const bus::SerialCounters counters = rig->port().counters();
  EXPECT_EQ(counters.messages_out * 16, received.size());
  EXPECT_EQ(counters.messages_out + counters.writes_superseded, 4U);
}

TEST_P(SerialPortContract, AMessageThatIsUnderWayIsSentWholeAndThenTheNewest) {
  rig->set_deaf(true);
  EXPECT_EQ(rig->port().submit(pattern(16, 1)), IoStatus::Ok);
  run_ms(5);
  const bool is_one_with_kernel = rig->has_kernel();
  EXPECT_EQ(rig->port().submit(pattern(16, 2)),
            is_one_with_kernel ? IoStatus::Ok : IoStatus::Backlogged);
  EXPECT_EQ(rig->port().submit(pattern(16, 3)), IoStatus::Backlogged);
  run_ms(5);
  EXPECT_TRUE(rig->received_by_device().empty());
  EXPECT_EQ(rig->port().counters().messages_out, is_one_with_kernel ? 1U : 0U);

  rig->set_deaf(false);
  run_ms(10);
  EXPECT_EQ(rig->received_by_device(), pattern(16, 1) + pattern(16, 3));
  EXPECT_EQ(rig->port().counters().writes_superseded, 1U);
  EXPECT_EQ(rig->port().submit(pattern(16, 4)), IoStatus::Ok) << "the mailbox is free again";
}

TEST_P(SerialPortContract, ALineThatHangsOutwardsHoldsUpNoInput) {
  rig->set_deaf(true);
  rig->port().submit(pattern(16, 1));
  rig->device_sends(pattern(16, 2));
  run_ms(5);
  EXPECT_EQ(read_all(), pattern(16, 2));
}

TEST_P(SerialPortContract, WhatCannotBeSentIsRefusedAndNotSent) {
  for (const std::size_t size : {std::size_t{0}, bus::kMaxSerialBytes + 1, std::size_t{5000}}) {
    EXPECT_EQ(rig->port().submit(pattern(size, 1)), IoStatus::ProtocolError) << size;
  }
  run_ms(3);
  EXPECT_TRUE(rig->received_by_device().empty());
  EXPECT_EQ(rig->port().counters(), bus::SerialCounters{});
}

TEST_P(SerialPortContract, AfterUnplugEveryCallSaysDisconnected) {
  rig->device_sends(pattern(16, 1));
  run_ms(2);
  rig->unplug();
  run_ms(5);
  bus::SerialChunk chunk;
  chunk.sequence = 77;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(rig->port().read(chunk), IoStatus::Disconnected);
    EXPECT_EQ(rig->port().submit(pattern(16, 1)), IoStatus::Disconnected);
    run_ms(1);
  }
  EXPECT_EQ(chunk.sequence, 77U);
}

TEST_P(SerialPortContract, ClosingEndsSilent) {
  rig->port().submit(pattern(16, 1));
  run_ms(5);
  rig->close_port();
  run_ms(5);
  EXPECT_EQ(rig->received_by_device(), pattern(16, 1));
}

// Random traffic: no byte is lost, doubled or moved, no message is cut, stamps never run backwards.
TEST_P(SerialPortContract, TheCountersBalanceUnderRandomTraffic) {
  std::mt19937 random(5);
  Bytes sent;
  Bytes read;
  std::uint64_t submitted = 0;
  MonotonicTime last_arrival{};
  std::uint64_t chunks = 0;
  const auto drain = [&] {
    bus::SerialChunk chunk;
    while (rig->port().read(chunk) == IoStatus::Ok) {
      EXPECT_GE(chunk.arrived_at, last_arrival);
      EXPECT_EQ(chunk.sequence, ++chunks);
      last_arrival = chunk.arrived_at;
      read.insert(read.end(), chunk.payload().begin(), chunk.payload().end());
    }
  };
  for (int step = 0; step < 400; ++step) {
    switch (random() % 5) {
      case 0: {
        const Bytes more = pattern(1 + random() % 100, static_cast<unsigned>(random()));
        rig->device_sends(more);
        sent = sent + more;
        break;
      }
      case 1:  // the first byte is the length of the rest
        ++submitted;
        rig->port().submit(Bytes{static_cast<std::uint8_t>(submitted % 90)} +
                           pattern(submitted % 90, 0));
        break;
      case 2:
        rig->set_deaf(random() % 2 == 0);
        break;
      case 3:
        run_ms(static_cast<int>(random() % 3));
        break;
      default:
        drain();
    }
  }
  rig->set_deaf(false);
  for (int ms = 0; ms < 20'000 && read.size() < sent.size(); ++ms) {
    run_ms(1);
    drain();
  }
  run_ms(20);
  EXPECT_EQ(read, sent);
  const std::uint64_t messages = whole_messages(rig->received_by_device());
  const bus::SerialCounters counters = rig->port().counters();
  EXPECT_EQ(counters.messages_out, messages);
  EXPECT_EQ(counters.messages_out + counters.writes_superseded, submitted);
  EXPECT_EQ(counters.bytes_in, sent.size());
}

}  // namespace thimble::test
