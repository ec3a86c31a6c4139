#include "lab/run/uart.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace thimble::lab {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::byte> bytes_of(const std::vector<unsigned>& numbers) {
  std::vector<std::byte> bytes;
  for (const unsigned number : numbers) bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

std::vector<std::byte> every_byte() {
  std::vector<unsigned> numbers;
  for (unsigned number = 0; number < 256; ++number) numbers.push_back(number);
  return bytes_of(numbers);
}

// All that is handed over, whenever it is due.
std::vector<std::byte> heard(const UartSender& from, UartReceiver& to) {
  std::vector<std::byte> all;
  for (auto due = to.due(from); due; due = to.due(from)) {
    const std::vector<std::byte> some = to.hear(from, *due);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

TEST(BitClock, CutsTimeIntoBitsThatNeverDrift) {
  for (const std::uint32_t rate : {38'400U, 115'200U, 3'000'000U}) {
    const BitClock sut(rate);
    EXPECT_EQ(sut.time_of(rate), seconds(1));
    EXPECT_EQ(sut.begin_of(std::int64_t{rate} * 86'400).since_epoch, seconds(86'400));
    EXPECT_EQ(sut.bit_at({}), 0);
    for (const std::int64_t bit : {1L, 9L, 1'000'003L, 259'200'000'001L}) {
      const MonotonicTime begin = sut.begin_of(bit);
      EXPECT_EQ(sut.bit_at(begin), bit);
      EXPECT_EQ(sut.bit_at(begin - nanoseconds(1)), bit - 1);
    }
  }
}

TEST(Uart, EveryByteIsHeardAsItWasSentAtEveryRate) {
  for (const std::uint32_t rate : {38'400U, 57'600U, 115'200U, 921'600U, 3'000'000U}) {
    UartSender sender(rate);
    UartReceiver receiver(rate, {});
    sender.put(every_byte(), MonotonicTime{microseconds(1234)});
    EXPECT_EQ(heard(sender, receiver), every_byte()) << rate;
    EXPECT_THAT(heard(sender, receiver), IsEmpty()) << "once";
  }
}

// 10 bits a byte at 100 us a bit.
TEST(Uart, WhatIsEnoughIsHandedOverWhenItIsThereAndTheRestWhenTheLineIsSilent) {
  UartSender sender(10'000);
  UartReceiver receiver(10'000, {});
  sender.put(bytes_of({1, 2, 3, 4, 5, 6, 7, 8, 9}), {});
  const MonotonicTime enough{microseconds(8'000)};
  EXPECT_THAT(receiver.hear(sender, enough - nanoseconds(1)), IsEmpty());
  EXPECT_EQ(receiver.hear(sender, enough).size(), UartReceiver::kTrigger);
  const MonotonicTime silent{microseconds(9'000 + 4'000)};
  EXPECT_THAT(receiver.hear(sender, silent - nanoseconds(1)), IsEmpty());
  EXPECT_EQ(receiver.due(sender), silent);
  EXPECT_THAT(receiver.hear(sender, silent), ElementsAre(std::byte{9}));
  EXPECT_EQ(receiver.due(sender), std::nullopt);
}

TEST(Uart, BytesLeaveOneBehindTheOtherAndAreCountedUntilTheyHave) {
  UartSender sut(10'000);
  sut.put(bytes_of({1, 2}), {});
  sut.put(bytes_of({3}), MonotonicTime{microseconds(500)});
  EXPECT_EQ(sut.held({}), 3U);
  EXPECT_EQ(sut.held(MonotonicTime{microseconds(999)}), 3U);
  EXPECT_EQ(sut.held(MonotonicTime{microseconds(1'000)}), 2U);
  EXPECT_EQ(sut.held(MonotonicTime{microseconds(3'000)}), 0U);
  EXPECT_EQ(sut.comes_down_to(1), MonotonicTime{microseconds(2'000)});
  EXPECT_EQ(sut.held(sut.comes_down_to(2)), 2U);
  // Between two bits: it leaves with the next.
  sut.put(bytes_of({4}), MonotonicTime{microseconds(5'030)});
  EXPECT_EQ(sut.comes_down_to(0), MonotonicTime{microseconds(6'100)});
}

// 55 at half the rate: each of its bits is two of the receiver's. By hand, low first:
//   sent     0    1    0    1    0    1    0    1    0    1
//   heard    00   11   00   11   00   11   00   11   00   11
//            0 01100110 0: 66, its stop bit low; from the next fall on 0 01100111 1: e6
TEST(Uart, AnotherRateIsHeardAsWhatIsInTheMiddleOfEachBit) {
  UartSender sender(10'000);
  UartReceiver receiver(20'000, {});
  sender.put(bytes_of({0x55}), {});
  EXPECT_EQ(heard(sender, receiver), bytes_of({0x66, 0xE6}));
}

// A sender holds the line low for nine bits at most, which are not ten of a slower one's.
TEST(Uart, ASlowerReceiverHearsNoZeroByte) {
  for (const std::uint32_t rate : {57'600U, 38'400U}) {
    UartSender sender(115'200);
    UartReceiver receiver(rate, {});
    for (int i = 0; i < 20; ++i) sender.put(every_byte(), {});
    const std::vector<std::byte> bytes = heard(sender, receiver);
    EXPECT_GT(bytes.size(), 500U);
    EXPECT_EQ(std::count(bytes.begin(), bytes.end(), std::byte{0}), 0) << rate;
  }
}

TEST(Uart, WhoComesInTheMiddleIsInStepAgainWhereTheLineRests) {
  UartSender sender(10'000);
  UartReceiver receiver(10'000, MonotonicTime{microseconds(350)});
  sender.put(bytes_of({0x0F, 0x0F}), {});
  sender.put(every_byte(), MonotonicTime{microseconds(10'000)});
  const std::vector<std::byte> bytes = heard(sender, receiver);
  ASSERT_GE(bytes.size(), 256U);
  EXPECT_EQ(std::vector(bytes.end() - 256, bytes.end()), every_byte());
}

TEST(Uart, WhatIsForgottenIsNotHeardAndTheRestIs) {
  UartSender sender(10'000);
  sender.put(bytes_of({1, 2, 3}), {});
  sender.forget_before(sender.clock().bit_at(MonotonicTime{microseconds(2'000)}));
  UartReceiver receiver(10'000, {});
  EXPECT_EQ(heard(sender, receiver), bytes_of({3}));
}

}  // namespace
}  // namespace thimble::lab
