#include "daemon/app/serial_lines.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <semaphore>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sim/time/virtual_clock.hpp"

namespace thimble::app {
namespace {

// Stands for the kernel: each device answers when its test lets it.
struct SerialLinesTest : testing::Test {
  struct Line {
    explicit Line(SerialLinesTest& test) : owner(&test) {}
    ~Line() {
      owner->may_close.acquire();
      owner->closed_in = std::this_thread::get_id();
      owner->has_closed.release();
    }
    Line(const Line&) = delete;
    Line& operator=(const Line&) = delete;
    SerialLinesTest* owner;
    int file{7};
  };
  Result<link::LineNode> open(const std::string& node, std::uint32_t bit_per_s) {
    ++asked;
    if (node == "/dev/hangs") may_open.acquire();
    if (node == "/dev/none") return fail(Errc::NotFound, "there is none");
    if (node == "/dev/throws") throw std::runtime_error("no memory");
    rate = bit_per_s;
    const auto line = std::make_shared<const Line>(*this);
    return link::LineNode(line, &line->file);
  }
  static Result<link::LineNode> answer_of(std::future<Result<link::LineNode>> future) {
    return future.get();
  }

  std::counting_semaphore<> may_open{0};
  std::counting_semaphore<> may_close{0};
  std::counting_semaphore<> has_closed{0};
  std::atomic<std::thread::id> closed_in{};
  std::atomic<int> asked{0};
  std::atomic<std::uint32_t> rate{0};
  SerialLines sut{[this](const std::string& node, std::uint32_t bits) { return open(node, bits); }};
};

TEST_F(SerialLinesTest, AnOpenedLineIsClosedInTheThreadThatOpenedItAndWhoLetsGoDoesNotWait) {
  auto node = answer_of(sut.open("/dev/ttyS0", 115'200)).value();
  EXPECT_EQ(*node, 7);
  EXPECT_EQ(rate, 115'200U);
  node.reset();  // though the kernel hangs in it
  may_close.release();
  has_closed.acquire();
  EXPECT_NE(closed_in.load(), std::this_thread::get_id());
}

TEST_F(SerialLinesTest, OneThatHangsKeepsNoOtherWaiting) {
  auto late = sut.open("/dev/hangs", 9600);
  EXPECT_EQ(answer_of(sut.open("/dev/none", 9600)).error().message, "there is none");
  EXPECT_EQ(late.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  may_open.release();
  auto node = answer_of(std::move(late)).value();
  may_close.release();
  node.reset();
  has_closed.acquire();
}

TEST_F(SerialLinesTest, SaysWhichDevicesAreNotDone) {
  sim::VirtualClock clock;
  auto late = sut.open("/dev/hangs", 9600);
  EXPECT_EQ(sut.late_after(Duration(0), clock), std::vector<std::string>{"/dev/hangs"});
  may_open.release();
  auto node = answer_of(std::move(late)).value();
  node.reset();
  EXPECT_EQ(sut.late_after(Duration(0), clock), std::vector<std::string>{"/dev/hangs"});
  may_close.release();
  EXPECT_TRUE(sut.late_after(std::chrono::seconds(60), clock).empty());
}

TEST_F(SerialLinesTest, ALineMayOutliveItsOpener) {
  auto lines = std::make_unique<SerialLines>(
      [this](const std::string& node, std::uint32_t bits) { return open(node, bits); });
  auto node = answer_of(lines->open("/dev/ttyS0", 9600)).value();
  lines.reset();
  node.reset();
  may_close.release();
  EXPECT_TRUE(has_closed.try_acquire_for(std::chrono::seconds(60)));
  EXPECT_NE(closed_in.load(), std::this_thread::get_id());
}

TEST_F(SerialLinesTest, AnOpenerThatEndsWhileOneHangsDoesNotWait) {
  auto lines = std::make_unique<SerialLines>(
      [this](const std::string& node, std::uint32_t bits) { return open(node, bits); });
  auto late = lines->open("/dev/hangs", 9600);
  while (asked == 0) std::this_thread::yield();
  lines.reset();
  may_open.release();
  auto node = answer_of(std::move(late)).value();
  may_close.release();
  node.reset();
  EXPECT_TRUE(has_closed.try_acquire_for(std::chrono::seconds(60)));
  EXPECT_NE(closed_in.load(), std::this_thread::get_id());
}

TEST_F(SerialLinesTest, WhatIsThrownIsAnError) {
  EXPECT_EQ(answer_of(sut.open("/dev/throws", 9600)).error().message,
            "/dev/throws cannot be opened: no memory");
}

TEST_F(SerialLinesTest, ALineThatWasLetGoOfIsClosedBeforeItIsOpenedAgain) {
  auto node = answer_of(sut.open("/dev/ttyS0", 9600)).value();
  node.reset();
  auto again = sut.open("/dev/ttyS0", 9600);
  EXPECT_EQ(again.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  EXPECT_EQ(asked, 1);
  may_close.release();
  has_closed.acquire();
  auto second = answer_of(std::move(again)).value();
  EXPECT_EQ(asked, 2);
  may_close.release();
  second.reset();
  has_closed.acquire();
}

}  // namespace
}  // namespace thimble::app
