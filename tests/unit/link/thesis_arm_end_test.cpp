#include "daemon/link/thesis_arm_end.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <random>
#include <vector>

#include "daemon/link/thesis_world_end.hpp"
#include "tests/unit/link/thesis_1999.hpp"
#include "tests/unit/link/world_double.hpp"

namespace thimble::link {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using y1999::Datagram;

MonotonicTime ms(std::int64_t value) { return {milliseconds(value)}; }

// A 1 kHz servo, a network and a server of 1999, in virtual time with a step of 1 ms.
class Net1999 {
 public:
  explicit Net1999(const ThesisArmEnd::Settings& settings, std::uint64_t seed = 1)
      : sut(settings), random_(seed) {}

  void run(Duration length) {
    for (const MonotonicTime end = now + length; now < end; now = now + milliseconds(1)) step();
  }
  [[nodiscard]] LinkCounters counters() const { return sut.status().counters; }

  ThesisArmEnd sut;
  MonotonicTime now{};
  Duration delay{};  // of the round trip
  double loss{0};    // of the round trip
  double duplicate{0};
  bool is_server_up{true};
  bool is_sending{true};
  Position3 hand{0.016, 0, 0};
  std::vector<coupling::ConstraintSet> accepted;

 private:
  struct Flight {
    MonotonicTime due{};
    Datagram reply;
  };

  void step() {
    if (is_sending) sut.offer({.sequence = ++sequence_, .sampled_at = now, .hand = hand});
    ThesisRequest request;
    while (sut.poll(now, request)) transmit(request);
    deliver();
    while (sut.poll(now, request)) transmit(request);
    deliver();
  }
  void transmit(const ThesisRequest& request) {
    if (!is_server_up || chance(loss)) return;
    const Datagram reply = server_.answer(request);
    flights_.push_back({now + delay, reply});
    if (chance(duplicate)) flights_.push_back({now + delay, reply});
  }
  void deliver() {
    while (!flights_.empty() && flights_.front().due <= now) {
      EXPECT_EQ(sut.on_datagram(flights_.front().reply, now), std::nullopt);
      flights_.pop_front();
    }
    coupling::ConstraintSet reply;
    while (sut.take_reply(now, reply)) accepted.push_back(reply);
  }
  bool chance(double probability) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < probability;
  }

  y1999::Server server_;
  std::deque<Flight> flights_;
  std::uint64_t sequence_{0};
  std::mt19937_64 random_;
};

double seconds_of(const Net1999& net) { return thimble::seconds(net.sut.status().round_trip); }

TEST(ThesisArmEnd, StreamsToAServerOf1999) {
  Net1999 net({});
  net.run(milliseconds(100));
  EXPECT_EQ(net.counters().sent, 100U);
  ASSERT_EQ(net.accepted.size(), 100U);
  for (std::size_t i = 0; i < net.accepted.size(); ++i) {
    const coupling::ConstraintSet& reply = net.accepted[i];
    EXPECT_EQ(reply.sequence, i + 1);
    EXPECT_EQ(reply.answers, 0U);  // the carriage cannot tell
    EXPECT_EQ(reply.session, 1U);
    ASSERT_EQ(reply.planes.size(), 1U);  // the garbage of y and z stays outside
    EXPECT_EQ(reply.planes[0].normal, (Direction3{1, 0, 0}));
    EXPECT_EQ(reply.planes[0].offset_m, 0.015);
  }
  EXPECT_TRUE(net.sut.quality().is_up);
  EXPECT_EQ(net.counters().lost, 0U);
}

TEST(ThesisArmEnd, MeasuresTheRoundTripOfAStream) {
  for (const int delay_ms : {2, 20, 100, 500}) {
    Net1999 net({});
    net.delay = milliseconds(delay_ms);
    net.run(seconds(5));
    EXPECT_NEAR(seconds_of(net), delay_ms * 1e-3, 0.004) << delay_ms;
    EXPECT_GT(net.accepted.size(), 3500U);
  }
}

TEST(ThesisArmEnd, OneLostDatagramStopsNothingInEitherMode) {
  for (const SendMode mode : {SendMode::Streamed, SendMode::LockStep}) {
    Net1999 net({.mode = mode});
    net.delay = milliseconds(2);
    net.run(milliseconds(200));
    net.loss = 1;
    net.run(milliseconds(4));
    net.loss = 0;
    const std::size_t before = net.accepted.size();
    net.run(milliseconds(200));
    EXPECT_GT(net.accepted.size(), before + 40);
    EXPECT_EQ(net.accepted.back().session, 1U);
    EXPECT_TRUE(net.sut.quality().is_up);
    EXPECT_NEAR(seconds_of(net), 0.002, 0.005);
  }
}

TEST(ThesisArmEnd, NeverStopsUnderLossAndDuplication) {
  for (const SendMode mode : {SendMode::Streamed, SendMode::LockStep}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Net1999 net({.mode = mode}, seed);
      net.delay = milliseconds(5);
      net.loss = 0.1;
      net.duplicate = 0.02;
      std::size_t before = 0;
      for (int second = 0; second < 20; ++second) {
        net.run(seconds(1));
        EXPECT_GE(net.accepted.size(), before + (mode == SendMode::Streamed ? 800 : 1));
        before = net.accepted.size();
      }
      EXPECT_GT(net.counters().lost, 20U);
      EXPECT_LT(seconds_of(net), 0.030);  // an estimate, and bounded
    }
  }
}

TEST(ThesisArmEnd, LockStepKeepsOneRequestInFlight) {
  Net1999 net({.mode = SendMode::LockStep});
  net.delay = milliseconds(50);
  net.run(seconds(2));
  EXPECT_NEAR(static_cast<double>(net.counters().sent), 40, 2);
  EXPECT_EQ(net.counters().timed_out, 0U);
  EXPECT_EQ(net.sut.status().round_trip, milliseconds(50));
}

TEST(ThesisArmEnd, LockStepIsNotOneReplyBehindAfterALateOne) {
  Net1999 net({.mode = SendMode::LockStep});
  net.delay = milliseconds(2);
  net.run(milliseconds(100));
  net.delay = milliseconds(70);  // longer than the time-out
  net.run(milliseconds(600));
  net.delay = milliseconds(2);
  net.run(milliseconds(600));
  const std::uint64_t sent = net.counters().sent;
  const std::uint64_t received = net.counters().received;
  net.run(milliseconds(500));
  EXPECT_LE(net.counters().sent - sent, 500U / 2 + 1);  // two in flight would double it
  EXPECT_NEAR(static_cast<double>(net.counters().sent - sent),
              static_cast<double>(net.counters().received - received), 2);
  EXPECT_NEAR(seconds_of(net), 0.002, 0.001);
}

TEST(ThesisArmEnd, SilenceTakesTheLinkDownAndAReplyBeginsANewSession) {
  Net1999 net({});
  net.run(milliseconds(100));
  net.is_server_up = false;
  net.run(milliseconds(999));
  EXPECT_TRUE(net.sut.quality().is_up);
  net.run(milliseconds(3));
  EXPECT_FALSE(net.sut.quality().is_up);
  EXPECT_EQ(net.sut.quality().round_trip, Duration::zero());
  const std::uint64_t sent = net.counters().sent;
  net.run(seconds(10));
  EXPECT_LE(net.counters().sent - sent, 60U);  // it asks, but floods nobody
  EXPECT_GE(net.counters().sent - sent, 35U);
  net.is_server_up = true;
  net.run(milliseconds(300));
  ASSERT_TRUE(net.sut.quality().is_up);
  EXPECT_EQ(net.accepted.back().session, 2U);
  EXPECT_LT(net.accepted.back().sequence, 300U);
  EXPECT_LT(seconds_of(net), 0.002);
}

TEST(ThesisArmEnd, FindsAServerThatStartsLater) {
  Net1999 net({});
  net.is_server_up = false;
  net.delay = milliseconds(3);
  net.run(seconds(30));
  EXPECT_EQ(net.counters().sessions_opened, 0U);
  net.is_server_up = true;
  net.run(seconds(1));
  EXPECT_TRUE(net.sut.quality().is_up);
  EXPECT_NEAR(seconds_of(net), 0.003, 0.002);
}

TEST(ThesisArmEnd, AnArmThatPausesIsNotAPeerThatWasLost) {
  Net1999 net({});
  net.run(milliseconds(50));
  net.is_sending = false;
  net.run(milliseconds(500));
  net.is_sending = true;
  net.run(milliseconds(50));
  EXPECT_EQ(net.accepted.back().session, 1U);
  EXPECT_EQ(net.counters().lost, 0U);
}

TEST(ThesisArmEnd, RefusesMalformedRepliesEachForItsReason) {
  ThesisArmEnd sut({});
  sut.offer({.sequence = 1});
  ThesisRequest request;
  ASSERT_TRUE(sut.poll(ms(0), request));
  const auto reply = [](float x_mm, unsigned directions) {
    Datagram out = y1999::request(x_mm, 0, 0);
    out.push_back(static_cast<std::byte>(directions));
    return out;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(sut.on_datagram(Datagram(12), ms(1)), RejectReason::WrongSize);
  EXPECT_EQ(sut.on_datagram(Datagram(14), ms(1)), RejectReason::WrongSize);
  EXPECT_EQ(sut.on_datagram(reply(1, 0x40), ms(1)), RejectReason::BadDirection);
  EXPECT_EQ(sut.on_datagram(reply(1, 0x03), ms(1)), RejectReason::BadDirection);
  EXPECT_EQ(sut.on_datagram(reply(nan, 0x01), ms(1)), RejectReason::NonFinite);
  EXPECT_EQ(sut.on_datagram(reply(1e20F, 0x02), ms(1)), RejectReason::OutOfRange);
  coupling::ConstraintSet out;
  EXPECT_FALSE(sut.take_reply(ms(1), out));
  EXPECT_FALSE(sut.quality().is_up);
  EXPECT_EQ(sut.status().counters.rejected(), 6U);
  EXPECT_EQ(sut.on_datagram(reply(nan, 0x04), ms(1)), std::nullopt);
  EXPECT_TRUE(sut.take_reply(ms(1), out));
}

TEST(ThesisArmEnd, RefusesRepliesThatNothingAskedFor) {
  ThesisArmEnd sut({});
  coupling::ConstraintSet out;
  EXPECT_EQ(sut.on_datagram(Datagram(13), ms(0)), std::nullopt);
  EXPECT_FALSE(sut.take_reply(ms(0), out));
  EXPECT_FALSE(sut.quality().is_up);
  sut.offer({.sequence = 1});
  ThesisRequest request;
  ASSERT_TRUE(sut.poll(ms(1), request));
  for (int copy = 0; copy < 3; ++copy) sut.on_datagram(Datagram(13), ms(2));
  EXPECT_TRUE(sut.take_reply(ms(2), out));
  EXPECT_FALSE(sut.take_reply(ms(2), out));
  EXPECT_EQ(sut.status().counters.stale, 3U);
}

TEST(ThesisArmEnd, RandomBytesNeverYieldWhatIsNotFinite) {
  std::mt19937 random(4);
  ThesisArmEnd sut({});
  std::uint64_t accepted = 0;
  for (int i = 0; i < 100000; ++i) {
    sut.offer({.sequence = static_cast<std::uint64_t>(i) + 1});
    ThesisRequest request;
    while (sut.poll(ms(i), request)) {
    }
    Datagram datagram(random() % 3 == 0 ? 13 : random() % 65);
    for (std::byte& byte : datagram) byte = static_cast<std::byte>(random() & 0xFFU);
    sut.on_datagram(datagram, ms(i));
    for (coupling::ConstraintSet out; sut.take_reply(ms(i), out);) {
      ++accepted;
      for (const coupling::ConstraintPlane& plane : out.planes) {
        ASSERT_LE(std::abs(plane.offset_m), kMaxThesisCoordinate_m);
      }
    }
  }
  EXPECT_GT(accepted, 100U);
  EXPECT_GT(sut.status().counters.rejected(), 50000U);
}

TEST(ThesisArmEnd, KeepsAHandThatIsNoPositionFromTheWire) {
  ThesisArmEnd sut({});
  ThesisRequest request;
  sut.offer({.sequence = 1, .hand = {std::nan(""), 0, 0}});
  EXPECT_FALSE(sut.poll(ms(0), request));
  EXPECT_EQ(sut.status().counters.rejected(RejectReason::NonFinite), 1U);
  sut.offer({.sequence = 2});
  EXPECT_TRUE(sut.poll(ms(0), request));
}

// Silence would let the constraints of a hand that is out there fade, for as long as it stays.
TEST(ThesisArmEnd, AHandBeyondTheLimitStillAsks) {
  ThesisArmEnd sut({});
  ThesisRequest request;
  sut.offer({.sequence = 1, .hand = {0.001, 11, -1e30}});
  ASSERT_TRUE(sut.poll(ms(0), request));
  const auto sent = decode_thesis_request(request);
  ASSERT_TRUE(sent.has_value());
  EXPECT_NEAR(sent->x, 0.001, 1e-9);
  EXPECT_EQ(sent->y, kMaxThesisCoordinate_m);
  EXPECT_EQ(sent->z, -kMaxThesisCoordinate_m);
  EXPECT_EQ(sut.status().counters.rejected(), 0U);
}

TEST(ThesisArmEnd, MeetsOurWorldEndUnderEveryInjectedImpairment) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ImpairmentSettings bad{.delay_s = 0.02,
                                 .jitter_s = 0.02,
                                 .loss = 0.1,
                                 .duplicate = 0.05,
                                 .reorder = 0.05,
                                 .seed = seed};
    WorldDouble world;
    ThesisWorldEnd world_end({.impairment = bad}, world);
    ThesisArmEnd sut({});
    std::uint64_t accepted = 0;
    for (int i = 0; i < 5000; ++i) {
      sut.offer({.sequence = static_cast<std::uint64_t>(i) + 1, .hand = {0, -0.0151, 0}});
      for (ThesisRequest request; sut.poll(ms(i), request);) {
        world_end.on_datagram({}, request, ms(i));
      }
      for (ThesisWorldEnd::Reply reply; world_end.poll(ms(i), reply);) {
        sut.on_datagram(reply.bytes, ms(i));
      }
      for (coupling::ConstraintSet out; sut.take_reply(ms(i), out); ++accepted) {
        ASSERT_EQ(out.planes.size(), 1U);
        ASSERT_EQ(out.planes[0].normal, (Direction3{0, -1, 0}));
        ASSERT_EQ(out.session, 1U);
      }
    }
    EXPECT_GT(accepted, 3500U);
    EXPECT_EQ(world.opened, 1U);
    const LinkCounters counters = sut.status().counters;
    EXPECT_EQ(counters.received, counters.accepted + counters.stale + counters.rejected());
  }
}

}  // namespace
}  // namespace thimble::link
