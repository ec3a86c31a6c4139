#include "lab/run/virtual_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "sim/time/virtual_clock.hpp"
#include "tests/support/turns.hpp"

namespace thimble::lab {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kNode = "/dev/ttyS0";

link::SerialFrame frame_of(const std::string& words) {
  return link::frame(std::as_bytes(std::span(words)));
}

// An end of a line that keeps the datagrams it hears.
struct End {
  End(VirtualLines& lines, std::size_t host, const std::string& node, std::uint32_t bit_per_s)
      : port(lines.host(host).make_port(node, bit_per_s)) {
    port->start({.on_bytes =
                     [this](std::span<const std::byte> some) {
                       bytes.insert(bytes.end(), some.begin(), some.end());
                       for (const std::byte byte : some) {
                         const auto datagram = deframer.push(byte);
                         if (!datagram) continue;
                         const auto* first = reinterpret_cast<const char*>(datagram->data());
                         heard.emplace_back(first, datagram->size());
                         if (answer) answer();
                       }
                     },
                 .on_timer = [this] { ++rings; }});
  }
  void send(const std::string& words) {
    ASSERT_TRUE(port->has_room());
    port->send(frame_of(words));
  }

  std::unique_ptr<link::LinePort> port;
  link::Deframer deframer{};
  std::vector<std::byte> bytes{};
  std::vector<std::string> heard{};
  std::function<void()> answer{};
  int rings{0};
};

struct VirtualLinesTest : ::testing::Test {
  sim::VirtualClock clock{MonotonicTime{seconds(1)}};
  VirtualLines sut{clock, 3};

  // As VirtualSession: whenever something is due.
  void run_for(Duration duration) {
    const MonotonicTime end = clock.now() + duration;
    sut.pass();
    for (auto due = sut.due(); due && *due <= end; due = sut.due()) {
      (void)clock.sleep_until(std::max(*due, clock.now() + microseconds(1)));
      sut.pass();
    }
    (void)clock.sleep_until(end);
  }
};

TEST_F(VirtualLinesTest, CarriesBothWaysAtTheRateOfTheLine) {
  End arm(sut, 0, kNode, 115'200);
  End world(sut, 1, kNode, 115'200);
  world.answer = [&] { world.send("told"); };
  arm.send("asked");
  // 12 bytes a frame, each with as much silence as four behind it.
  const Duration way = Duration(10'000'000'000 / 115'200 * 16);
  run_for(way - microseconds(10));
  EXPECT_THAT(world.heard, IsEmpty());
  run_for(microseconds(30));
  EXPECT_THAT(world.heard, ElementsAre("asked"));
  EXPECT_THAT(arm.heard, IsEmpty());
  run_for(way);
  EXPECT_THAT(arm.heard, ElementsAre("told"));
}

// Whoever keeps to LinePace never finds the kernel full, and loses nothing of the rate.
TEST_F(VirtualLinesTest, APacedSenderHasAllOfTheRateAndNoQueue) {
  for (const std::uint32_t rate : {38'400U, 115'200U, 3'000'000U}) {
    End arm(sut, 0, kNode, rate);
    End world(sut, 1, kNode, rate);
    link::LinePace pace(rate);
    const std::string words(100, 'x');
    const std::size_t size = frame_of(words).size;
    const MonotonicTime end = clock.now() + seconds(2);
    while (clock.now() < end) {
      arm.send(words);
      pace.on_sent(size, clock.now());
      run_for(pace.free_at() - clock.now());
    }
    const double bytes = static_cast<double>(world.heard.size() * size);
    EXPECT_NEAR(bytes, 2 * rate / 10.0, 2.0 * static_cast<double>(size)) << rate;
    EXPECT_EQ(world.deframer.counters().damaged, 0U);
  }
}

TEST_F(VirtualLinesTest, TheKernelTakesAPageAndMoreWhenMostOfItHasLeft) {
  constexpr std::uint32_t kRate = 100'000;  // 100 us a byte
  End arm(sut, 0, kNode, kRate);
  End world(sut, 1, kNode, kRate);
  const std::string words(1200, 'x');
  const std::size_t size = frame_of(words).size;
  const std::size_t whole = VirtualLines::kKernelTakes / size;
  for (std::size_t i = 0; i < whole; ++i) {
    arm.send(words);
    EXPECT_FALSE(arm.port->has_room()) << "until the next pass";
    sut.pass();
  }
  arm.send(words);
  sut.pass();
  EXPECT_FALSE(arm.port->has_room());
  const std::size_t leaves_first = VirtualLines::kKernelTakes - VirtualLines::kKernelWakes;
  run_for(microseconds(100 * leaves_first) - milliseconds(1));
  EXPECT_FALSE(arm.port->has_room());
  const int rings = arm.rings;
  run_for(milliseconds(2));
  EXPECT_TRUE(arm.port->has_room());
  EXPECT_EQ(arm.rings, rings + 1);
  run_for(seconds(1));
  EXPECT_EQ(world.heard, std::vector<std::string>(whole + 1, words));
}

// Those rates that are nearest to each other, and one that is twice the other.
TEST_F(VirtualLinesTest, EndsOfTwoRatesHearDamagedFramesAndNoDatagram) {
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs{
      {115'200, 57'600},   {57'600, 115'200},      {3'000'000, 38'400},
      {38'400, 3'000'000}, {1'152'000, 1'000'000}, {1'000'000, 1'152'000}};
  for (const auto& [sent, heard] : pairs) {
    End arm(sut, 0, kNode, sent);
    End world(sut, 1, kNode, heard);
    std::mt19937 random(3);
    const auto damaged = [&] { return world.deframer.counters().damaged; };
    // A slow end hears one byte of many, and the end of a frame seldom: until it has heard one.
    constexpr int kAll = 2000;
    for (int i = 0; i < test::turns(kAll) || (i < kAll && damaged() == 0); ++i) {
      std::string words(60, ' ');
      for (char& one : words) one = static_cast<char>(random() & 0xFFU);
      arm.send(words);
      run_for(milliseconds(20));
    }
    EXPECT_GT(damaged(), 0U) << sent << " heard at " << heard;
    EXPECT_THAT(world.heard, IsEmpty());
  }
}

TEST_F(VirtualLinesTest, WhatNobodyIsThereToHearIsLost) {
  End arm(sut, 0, kNode, 115'200);
  arm.send("lost");
  run_for(seconds(1));
  EXPECT_TRUE(arm.port->has_room()) << "a line has no flow control";
  End world(sut, 1, kNode, 115'200);
  arm.send("heard");
  run_for(seconds(1));
  EXPECT_THAT(world.heard, ElementsAre("heard"));
}

TEST_F(VirtualLinesTest, OnlyDevicesOfTheSameNameOnTwoHostsAreJoined) {
  End arm(sut, 0, kNode, 115'200);
  End other(sut, 1, "/dev/ttyS1", 115'200);
  End beside(sut, 0, "/dev/ttyS1", 115'200);
  arm.send("hello");
  beside.send("ahoy");
  run_for(seconds(1));
  EXPECT_THAT(other.heard, ElementsAre("ahoy"));
  EXPECT_THAT(arm.bytes, IsEmpty());
  EXPECT_THAT(beside.bytes, IsEmpty());
}

TEST_F(VirtualLinesTest, ADeviceIsOpenOnceOnAHostAndAskedForAgain) {
  auto first = std::make_unique<End>(sut, 0, kNode, 115'200);
  End second(sut, 0, kNode, 115'200);
  EXPECT_EQ(second.port->last_error(), "/dev/ttyS0 is held by another daemon");
  EXPECT_FALSE(second.port->has_room());
  EXPECT_EQ(second.rings, 0);
  run_for(milliseconds(500));
  first.reset();
  run_for(milliseconds(600));
  EXPECT_TRUE(second.port->has_room());
  EXPECT_EQ(second.port->last_error(), "");
  EXPECT_EQ(second.rings, 1);
}

TEST_F(VirtualLinesTest, APortThatIsGoneHearsNothingAndAnotherTakesItsPlace) {
  End arm(sut, 0, kNode, 115'200);
  {
    End gone(sut, 1, kNode, 115'200);
    gone.send("cut off");
    arm.send("too late");
  }
  run_for(seconds(1));
  EXPECT_THAT(arm.heard, IsEmpty());
  End next(sut, 1, kNode, 115'200);
  arm.send("again");
  run_for(seconds(1));
  EXPECT_THAT(next.heard, ElementsAre("again"));
}

TEST_F(VirtualLinesTest, TheEarlierOfTwoWakesCounts) {
  End arm(sut, 0, kNode, 115'200);
  const int opened = arm.rings;
  EXPECT_FALSE(sut.due());
  for (const int ms : {5, 2, 9}) arm.port->wake_after(clock.now(), milliseconds(ms));
  EXPECT_EQ(sut.due(), clock.now() + milliseconds(2));
  run_for(milliseconds(1));
  EXPECT_EQ(arm.rings, opened);
  run_for(milliseconds(1));
  EXPECT_EQ(arm.rings, opened + 1);
  EXPECT_FALSE(sut.due());
}

}  // namespace
}  // namespace thimble::lab
