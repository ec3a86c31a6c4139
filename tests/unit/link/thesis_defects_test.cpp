#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "daemon/link/thesis_arm_end.hpp"
#include "daemon/link/thesis_world_end.hpp"
#include "tests/unit/link/thesis_1999.hpp"
#include "tests/unit/link/world_double.hpp"

// Defects of the printed network loops (docs/thesis-defects.md), absent in both of our ends.
namespace thimble::link {
namespace {

using std::chrono::milliseconds;

Endpoint peer(std::uint8_t host) {
  Endpoint out;
  out.address = {127, 0, 0, host};
  out.port = 40000;
  return out;
}

enum class Fate { Arrives, Lost, Twice };

// Our two ends with 2 ms between them; one datagram of either direction has a fate of its own.
class Wire {
 public:
  explicit Wire(SendMode mode) : arm_({.mode = mode}), world_({}, box_) {}

  void give(bool is_request, int number, Fate fate) {
    is_request_ = is_request;
    number_ = number;
    fate_ = fate;
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) step();
  }
  [[nodiscard]] Duration longest_gap() const { return longest_gap_; }
  [[nodiscard]] std::uint64_t replies() const { return replies_; }
  [[nodiscard]] std::uint64_t requests() const { return static_cast<std::uint64_t>(sent_[1]); }
  [[nodiscard]] const ThesisArmEnd& arm() const { return arm_; }

 private:
  template <class Bytes>
  void transmit(std::deque<std::pair<MonotonicTime, Bytes>>& flights, const Bytes& bytes,
                bool is_request) {
    const bool is_fated = is_request == is_request_ && ++sent_[is_request ? 1 : 0] == number_;
    if (is_request != is_request_) ++sent_[is_request ? 1 : 0];
    const int copies = !is_fated || fate_ == Fate::Arrives ? 1 : fate_ == Fate::Lost ? 0 : 2;
    for (int i = 0; i < copies; ++i) flights.emplace_back(now_ + milliseconds(1), bytes);
  }
  void step() {
    now_ = now_ + milliseconds(1);
    arm_.offer({.sequence = ++sequence_, .sampled_at = now_, .hand = {0.016, 0, 0}});
    for (; !requests_.empty() && requests_.front().first <= now_; requests_.pop_front()) {
      (void)world_.on_datagram(peer(1), requests_.front().second, now_);
    }
    for (ThesisWorldEnd::Reply reply; world_.poll(now_, reply);) {
      transmit(replies_in_flight_, reply.bytes, false);
    }
    for (; !replies_in_flight_.empty() && replies_in_flight_.front().first <= now_;
         replies_in_flight_.pop_front()) {
      (void)arm_.on_datagram(replies_in_flight_.front().second, now_);
    }
    for (coupling::ConstraintSet set; arm_.take_reply(now_, set);) {
      if (replies_ > 0) longest_gap_ = std::max(longest_gap_, now_ - last_reply_);
      last_reply_ = now_;
      ++replies_;
    }
    for (ThesisRequest request; arm_.poll(now_, request);) transmit(requests_, request, true);
  }

  WorldDouble box_;
  ThesisArmEnd arm_;
  ThesisWorldEnd world_;
  std::deque<std::pair<MonotonicTime, ThesisRequest>> requests_;
  std::deque<std::pair<MonotonicTime, ThesisReply>> replies_in_flight_;
  MonotonicTime now_{};
  MonotonicTime last_reply_{};
  Duration longest_gap_{};
  std::uint64_t sequence_{0};
  std::uint64_t replies_{0};
  bool is_request_{true};
  int number_{0};
  Fate fate_{Fate::Arrives};
  std::array<int, 2> sent_{};
};

TEST(ThesisDefect, ALostDatagramNeverDeadlocks) {
  for (const SendMode mode : {SendMode::Streamed, SendMode::LockStep}) {
    // A time-out and the drain of decision 0061; a stream hardly notices.
    const Duration longest = milliseconds(mode == SendMode::LockStep ? 100 : 3);
    for (const bool is_request : {true, false}) {
      for (int number = 2; number < 40; ++number) {
        Wire sut(mode);
        sut.give(is_request, number, Fate::Lost);
        sut.run(400);
        EXPECT_GT(sut.replies(), 90U);
        EXPECT_LE(sut.longest_gap(), longest) << number;
        EXPECT_TRUE(sut.arm().quality().is_up);
      }
    }
  }
}

TEST(ThesisDefect, ADuplicateLeavesTheArmNoReplyBehind) {
  Wire plain(SendMode::LockStep);
  plain.run(400);
  for (const bool is_request : {true, false}) {
    for (int number = 2; number < 40; ++number) {
      Wire sut(SendMode::LockStep);
      sut.give(is_request, number, Fate::Twice);
      sut.run(400);
      // One behind, two would be in flight for ever: twice the requests.
      EXPECT_LE(sut.requests(), plain.requests() + 2) << number;
      EXPECT_LE(sut.arm().status().round_trip, milliseconds(4)) << number;
    }
  }
}

TEST(ThesisDefect, WhatLiesInUnsetAxesIsNeitherReadNorSent) {
  y1999::Server printed;  // leaves NaN, infinity and huge numbers there
  ThesisArmEnd arm({});
  WorldDouble box;
  ThesisWorldEnd world({}, box);
  int read = 0;
  for (int i = 1; i <= 100; ++i) {
    const MonotonicTime now{milliseconds(i)};
    arm.offer(
        {.sequence = static_cast<std::uint64_t>(i), .sampled_at = now, .hand = {0.016, 0, 0}});
    for (ThesisRequest request; arm.poll(now, request);) {
      EXPECT_EQ(arm.on_datagram(printed.answer(request), now), std::nullopt);
      (void)world.on_datagram(peer(1), request, now);
    }
    for (coupling::ConstraintSet set; arm.take_reply(now, set); ++read) {
      ASSERT_EQ(set.planes.size(), 1U);
      EXPECT_EQ(set.planes[0].offset_m, 0.015);
    }
    for (ThesisWorldEnd::Reply reply; world.poll(now, reply);) {
      EXPECT_EQ(y1999::get_float(reply.bytes, 4), 0.0F);
      EXPECT_EQ(y1999::get_float(reply.bytes, 8), 0.0F);
    }
  }
  EXPECT_GT(read, 90);
}

TEST(ThesisDefect, NoNumberThatIsNoPlaceReachesTheCells) {
  WorldDouble box;
  ThesisWorldEnd sut({}, box);
  (void)sut.on_datagram(peer(1), y1999::request(1, 2, 3), {});
  for (ThesisWorldEnd::Reply reply; sut.poll({}, reply);) {
  }
  ASSERT_EQ(box.samples.size(), 1U);
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float value : {std::nanf(""), infinity, -infinity, 3e38F, -1e20F}) {
    EXPECT_NE(sut.on_datagram(peer(1), y1999::request(0, value, 0), {}), std::nullopt);
    for (ThesisWorldEnd::Reply reply; sut.poll({}, reply);) ADD_FAILURE() << value;
  }
  EXPECT_EQ(box.samples.size(), 1U);
}

TEST(ThesisDefect, AStrangerNeitherTakesTheSessionNorMovesItsHand) {
  WorldDouble box;
  ThesisWorldEnd sut({}, box);
  int to_stranger = 0;
  int to_owner = 0;
  for (int i = 0; i < 500; ++i) {
    const MonotonicTime now{milliseconds(i)};
    (void)sut.on_datagram(peer(1), y1999::request(1, 0, 0), now);
    (void)sut.on_datagram(peer(2), y1999::request(40, 0, 0), now);
    for (ThesisWorldEnd::Reply reply; sut.poll(now, reply);) {
      (reply.to == peer(1) ? to_owner : to_stranger) += 1;
    }
  }
  EXPECT_EQ(to_owner, 500);
  EXPECT_EQ(to_stranger, 0);
  for (const auto& sample : box.samples) EXPECT_NEAR(sample.hand.x, 0.001, 1e-9);
}

}  // namespace
}  // namespace thimble::link
