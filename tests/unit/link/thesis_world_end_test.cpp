#include "daemon/link/thesis_world_end.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "tests/unit/link/thesis_1999.hpp"
#include "tests/unit/link/world_double.hpp"

namespace thimble::link {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using y1999::Datagram;

MonotonicTime ms(int value) { return {milliseconds(value)}; }

Endpoint peer(std::uint8_t host, std::uint16_t port = 40000) {
  Endpoint out;
  out.address = {127, 0, 0, host};
  out.port = port;
  return out;
}

std::vector<ThesisWorldEnd::Reply> drain(ThesisWorldEnd& end, MonotonicTime now) {
  std::vector<ThesisWorldEnd::Reply> out;
  for (ThesisWorldEnd::Reply reply; end.poll(now, reply);) out.push_back(reply);
  return out;
}

class ThesisWorldEndTest : public ::testing::Test {
 protected:
  std::vector<ThesisWorldEnd::Reply> exchange(const Endpoint& from, const Datagram& datagram,
                                              MonotonicTime now) {
    sut.on_datagram(from, datagram, now);
    return drain(sut, now);
  }
  [[nodiscard]] LinkCounters counters() const { return sut.status().counters; }

  WorldDouble world;
  ThesisWorldEnd sut{{}, world};
  const Datagram centre = y1999::request(1, -2.5F, 3);
};

TEST_F(ThesisWorldEndTest, AnswersAHandAtTheWallAsIn1999) {
  const auto replies = exchange(peer(1), y1999::request(15.5F, 0, -16), ms(0));
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].to, peer(1));
  const auto& bytes = replies[0].bytes;
  EXPECT_EQ(y1999::get_float(bytes, 0), 15.0F);
  EXPECT_EQ(y1999::get_float(bytes, 4), 0.0F);
  EXPECT_EQ(y1999::get_float(bytes, 8), -15.0F);
  EXPECT_EQ(std::to_integer<unsigned>(bytes[12]), 0x21U);
}

TEST_F(ThesisWorldEndTest, TheFirstValidDatagramOpensTheSession) {
  exchange(peer(1), centre, ms(0));
  ASSERT_EQ(world.first_samples.size(), 1U);
  EXPECT_EQ(world.first_samples[0].hand, (Position3{0.001, -0.0025, 0.003}));
  EXPECT_EQ(sut.status().peer, "udp://127.0.0.1:40000");
  EXPECT_TRUE(sut.status().is_up);
  EXPECT_EQ(counters().sessions_opened, 1U);
}

TEST_F(ThesisWorldEndTest, AnswersEveryRequestOfABurstAndEveryDuplicateOnce) {
  for (int i = 0; i < 500; ++i) sut.on_datagram(peer(1), centre, ms(0));
  EXPECT_EQ(drain(sut, ms(0)).size(), 500U);
  EXPECT_EQ(counters().sent, 500U);
  EXPECT_EQ(counters().accepted, 500U);
  for (const Duration step : world.steps) EXPECT_EQ(step, WorldSession::kMinStep);
}

TEST_F(ThesisWorldEndTest, RefusesASecondPeerWhileTheFirstSpeaks) {
  for (int i = 0; i < 3000; ++i) {
    EXPECT_EQ(exchange(peer(1), centre, ms(i)).size(), 1U);
    EXPECT_TRUE(exchange(peer(2), centre, ms(i)).empty());
    EXPECT_TRUE(exchange(peer(1, 40001), centre, ms(i)).empty());  // the port counts too
  }
  EXPECT_EQ(counters().rejected(RejectReason::WrongPeer), 6000U);
  EXPECT_EQ(world.opened, 1U);
}

TEST_F(ThesisWorldEndTest, ReleasesASilentPeerAndThenTakesAnother) {
  exchange(peer(1), centre, ms(0));
  EXPECT_EQ(sut.next_due(), ms(1000));
  EXPECT_TRUE(drain(sut, ms(999)).empty());
  EXPECT_TRUE(world.is_open);
  EXPECT_TRUE(drain(sut, ms(1000)).empty());
  EXPECT_FALSE(world.is_open);
  EXPECT_FALSE(sut.status().is_up);
  EXPECT_EQ(sut.status().peer, "");
  EXPECT_EQ(counters().sessions_released, 1U);
  EXPECT_FALSE(sut.next_due().has_value());
  const auto replies = exchange(peer(2), centre, ms(1001));
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].to, peer(2));
  EXPECT_EQ(world.opened, 2U);
}

TEST_F(ThesisWorldEndTest, AnswersAWaitingClientOnceTheSessionIsFree) {
  // A client of 1999 restarted on another port: it has sent once and blocks for ever.
  exchange(peer(1), centre, ms(0));
  EXPECT_TRUE(exchange(peer(1, 40001), y1999::request(0, 16, 0), ms(500)).empty());
  EXPECT_TRUE(drain(sut, ms(999)).empty());
  const auto replies = drain(sut, ms(1000));
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].to, peer(1, 40001));
  EXPECT_EQ(std::to_integer<unsigned>(replies[0].bytes[12]), 0x04U);
  EXPECT_TRUE(drain(sut, ms(1001)).empty());
  EXPECT_EQ(counters().rejected(RejectReason::WrongPeer), 1U);
}

TEST_F(ThesisWorldEndTest, AsksARefusingWorldAgainForTheWaitingClient) {
  world.refusals = 2;
  EXPECT_TRUE(exchange(peer(1), centre, ms(0)).empty());
  EXPECT_FALSE(sut.status().is_up);
  EXPECT_NE(sut.status().last_error, "");
  EXPECT_EQ(sut.next_due(), ms(100));
  EXPECT_TRUE(drain(sut, ms(100)).empty());
  EXPECT_EQ(drain(sut, ms(200)).size(), 1U);
  EXPECT_EQ(counters().rejected(RejectReason::SessionRefused), 2U);
}

TEST_F(ThesisWorldEndTest, MalformedDatagramsNeitherOpenNorHoldASession) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<Datagram, RejectReason>> bad{
      {{}, RejectReason::WrongSize},
      {Datagram(11), RejectReason::WrongSize},
      {Datagram(13), RejectReason::WrongSize},
      {y1999::request(nan, 0, 0), RejectReason::NonFinite},
      {y1999::request(0, -std::numeric_limits<float>::infinity(), 0), RejectReason::NonFinite},
      {y1999::request(0, 0, 3e38F), RejectReason::OutOfRange}};
  for (const auto& [datagram, reason] : bad) {
    const std::uint64_t before = counters().rejected(reason);
    EXPECT_EQ(sut.on_datagram(peer(1), datagram, ms(0)), reason);
    EXPECT_EQ(counters().rejected(reason), before + 1);
  }
  EXPECT_TRUE(drain(sut, ms(0)).empty());
  EXPECT_EQ(world.opened, 0U);
  exchange(peer(1), centre, ms(0));
  for (int i = 0; i < 1000; ++i) exchange(peer(1), bad[3].first, ms(i));
  drain(sut, ms(1000));
  EXPECT_FALSE(world.is_open);
}

TEST_F(ThesisWorldEndTest, RandomBytesNeverOpenASession) {
  std::mt19937 random(21);
  std::uint64_t refused = 0;
  for (int i = 0; i < 100000; ++i) {
    Datagram datagram(random() % 65);
    for (std::byte& byte : datagram) byte = static_cast<std::byte>(random() & 0xFFU);
    if (datagram.size() == 12) datagram[0] = std::byte{0x7F};  // huge or not a number
    if (datagram.size() == 12) datagram[1] |= std::byte{0x80};
    refused +=
        sut.on_datagram(peer(static_cast<std::uint8_t>(random())), datagram, ms(i)) ? 1U : 0U;
    EXPECT_TRUE(drain(sut, ms(i)).empty());
  }
  EXPECT_EQ(refused, 100000U);
  EXPECT_EQ(counters().received, 100000U);
  EXPECT_EQ(counters().rejected(), 100000U);
  EXPECT_EQ(world.opened, 0U);
}

TEST_F(ThesisWorldEndTest, TellsTheWorldTheTimeBetweenRequestsWithinBounds) {
  exchange(peer(1), centre, ms(0));
  exchange(peer(1), centre, ms(4));
  exchange(peer(1), centre, ms(904));
  EXPECT_EQ(world.steps,
            (std::vector<Duration>{microseconds(1), milliseconds(4), milliseconds(50)}));
}

TEST_F(ThesisWorldEndTest, CountsPlanesTheDatagramCannotCarry) {
  const coupling::ConstraintPlane tilted{.normal = {0.6, 0.8, 0}, .offset_m = 0};
  world.extra_plane = &tilted;
  const auto replies = exchange(peer(1), y1999::request(16, 0, 0), ms(0));
  EXPECT_EQ(std::to_integer<unsigned>(replies.at(0).bytes[12]), 0x01U);
  EXPECT_EQ(counters().unencodable_planes, 1U);
}

TEST(ThesisWorldEndPinned, OnlyThePinnedAddressIsHeard) {
  WorldDouble world;
  ThesisWorldEnd sut({.pinned_peer = peer(7, 0)}, world);
  const Datagram centre = y1999::request(0, 0, 0);
  EXPECT_EQ(sut.on_datagram(peer(1), centre, ms(0)), RejectReason::WrongPeer);
  EXPECT_TRUE(drain(sut, ms(0)).empty());
  EXPECT_EQ(sut.on_datagram(peer(7), centre, ms(0)), std::nullopt);
  EXPECT_EQ(drain(sut, ms(0)).size(), 1U);
  EXPECT_EQ(sut.status().counters.rejected(RejectReason::WrongPeer), 1U);
}

// A client of 1999 sends, blocks, and sends again only when a reply has come.
TEST(ThesisWorldEndWith1999Client, AnInjectedDelayIsItsRoundTripAndNothingBlocks) {
  WorldDouble world;
  ThesisWorldEnd sut({.impairment = {.delay_s = 0.1}}, world);
  MonotonicTime now = ms(0);
  for (int exchanges = 0; exchanges < 50; ++exchanges) {
    const MonotonicTime sent = now;
    sut.on_datagram(peer(1), y1999::request(0, 20, 0), now);
    std::vector<ThesisWorldEnd::Reply> replies = drain(sut, now);
    while (replies.empty()) {
      ASSERT_TRUE(sut.next_due().has_value());
      now = *sut.next_due();
      replies = drain(sut, now);
    }
    ASSERT_EQ(replies.size(), 1U);
    EXPECT_EQ(now - sent, milliseconds(100));
  }
  EXPECT_EQ(world.opened, 1U);
}

TEST(ThesisWorldEndWith1999Client, AClientBlockedByInjectedLossIsReleased) {
  WorldDouble world;
  ThesisWorldEnd sut({.impairment = {.loss = 1.0}}, world);
  sut.on_datagram(peer(1), y1999::request(0, 0, 0), ms(0));
  EXPECT_TRUE(drain(sut, ms(0)).empty());
  EXPECT_EQ(sut.status().counters.injected.lost, 1U);
  EXPECT_FALSE(sut.next_due().has_value());
}

}  // namespace
}  // namespace thimble::link
