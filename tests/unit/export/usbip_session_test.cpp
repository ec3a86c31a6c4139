#include "sim/export/usbip_session.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <map>
#include <memory>
#include <random>
#include <set>

#include "tests/unit/export/usbip_session_fixture.hpp"

namespace thimble::sim {
namespace {

// Seeded; below `bound`.
class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(random_() % bound); }

 private:
  std::mt19937 random_;
};

TEST_F(UsbipSessionTest, ListsTheDeviceAndLetsItBeAttached) {
  say(UsbipHost::devlist());
  EXPECT_EQ(sut_.outbox().size(), 328U);
  EXPECT_FALSE(sut_.is_attached());
  sut_.outbox().clear();
  attach();
  EXPECT_TRUE(sut_.is_attached());
}

TEST_F(UsbipSessionTest, GivesNothingAwayWhenItIsNotThereOrCalledOtherwise) {
  say(UsbipHost::import("1-2"));
  EXPECT_EQ(sut_.outbox(), (Bytes{0x01, 0x11, 0, 3, 0, 0, 0, 1}));
  sut_.outbox().clear();
  sut_.set_available(false);
  say(UsbipHost::import());
  EXPECT_FALSE(sut_.is_attached());
  sut_.outbox().clear();
  say(UsbipHost::devlist());
  EXPECT_EQ(sut_.outbox().size(), 12U);
}

TEST_F(UsbipSessionTest, TakesItsMessagesInAnyPieces) {
  Bytes all = UsbipHost::import();
  for (const Bytes& more :
       {host_.write(Model::kBulkOut, {1, 2, 3}), host_.read(Model::kBulkIn, 64)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  for (const std::uint8_t byte : all) say({byte});
  EXPECT_EQ(sut_.waiting(), 2U);
  serve();
  EXPECT_EQ(script_->received[Model::kBulkOut], (std::vector<Bytes>{{1, 2, 3}}));
}

TEST_F(UsbipSessionTest, AnswersStandardRequestsItself) {
  attach();
  const auto device = transfer(host_.control({0x80, 6, 0, 1, 0, 0, 18, 0}), true);
  EXPECT_EQ(device.status, 0);
  EXPECT_EQ(device.data.size(), 18U);
  const auto part = transfer(host_.control({0x80, 6, 0, 2, 0, 0, 9, 0}), true);
  EXPECT_EQ(part.data.size(), 9U) << "no more than was asked for";
  EXPECT_EQ(transfer(host_.control({0x80, 6, 0, 6, 0, 0, 10, 0}), true).status, -EPIPE);
  EXPECT_TRUE(script_->requests.empty());
}

TEST_F(UsbipSessionTest, HandsOtherRequestsToTheModel) {
  attach();
  script_->control_answer = {16};
  const auto in = transfer(host_.control({0xC0, 10, 0, 0, 0, 0, 1, 0}), true);
  EXPECT_EQ(in.data, Bytes{16});
  const auto out = transfer(host_.control({0x40, 9, 1, 0, 0, 0, 2, 0}, {7, 8}), false);
  EXPECT_EQ(out.status, 0);
  EXPECT_EQ(out.actual, 2U);
  ASSERT_EQ(script_->requests.size(), 2U);
  EXPECT_EQ(script_->requests[1].data[1], 8);
  script_->stalls_to_come.insert(0);
  EXPECT_EQ(transfer(host_.control({0x40, 9, 1, 0, 0, 0, 0, 0}), false).status, -EPIPE);
}

TEST_F(UsbipSessionTest, RefusesARequestThatIsTooLongForAModel) {
  attach();
  EXPECT_EQ(transfer(host_.control({0x40, 9, 1, 0, 0, 0, 65, 0}, Bytes(65)), false).status, -EPIPE);
  EXPECT_TRUE(script_->requests.empty());
}

TEST_F(UsbipSessionTest, CutsWhatGoesOutIntoPackets) {
  attach();
  Bytes data(150);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint8_t>(i);
  const auto reply = transfer(host_.write(Model::kBulkOut, data), false);
  EXPECT_EQ(reply.status, 0);
  EXPECT_EQ(reply.actual, 150U);
  const auto& packets = script_->received[Model::kBulkOut];
  ASSERT_EQ(packets.size(), 3U);
  Bytes joined;
  for (const Bytes& packet : packets) joined.insert(joined.end(), packet.begin(), packet.end());
  EXPECT_EQ(joined, data);
  EXPECT_EQ(packets[2].size(), 22U);
}

TEST_F(UsbipSessionTest, GathersPacketsUntilAShortOne) {
  attach();
  script_->to_send[Model::kBulkIn] = {Bytes(64, 1), Bytes(64, 2), Bytes(10, 3), Bytes(5, 4)};
  const auto reply = transfer(host_.read(Model::kBulkIn, 512), true);
  EXPECT_EQ(reply.status, 0);
  EXPECT_EQ(reply.data.size(), 138U);
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).data, Bytes(5, 4));
}

TEST_F(UsbipSessionTest, WaitsForADeviceThatHasNothing) {
  attach();
  say(host_.read(Model::kBulkIn, 64));
  serve(100);
  EXPECT_TRUE(sut_.outbox().empty());
  script_->to_send[Model::kBulkIn] = {{9}};
  serve();
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), true)->data, Bytes{9});
}

TEST_F(UsbipSessionTest, SaysHowATransferWentWrong) {
  attach();
  script_->to_send[Model::kBulkIn] = {Bytes(65, 1), Bytes(64, 2), {3}};
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 512), true).status, -EOVERFLOW);
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 32), true).status, -EOVERFLOW);
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64, 1), true).status, -EREMOTEIO);
  EXPECT_EQ(transfer(host_.read(0x8F, 64), true).status, -EPIPE) << "no such endpoint";
  script_->stalls_to_come.insert(Model::kBulkOut);
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {1}), false).status, -EPIPE);
}

// As a host controller: what was queued behind the transfer that stalled is not tried.
TEST_F(UsbipSessionTest, AHaltedEndpointWaitsUntilItsHaltIsEnded) {
  attach();
  script_->stalls_to_come.insert(Model::kBulkIn);
  script_->to_send[Model::kBulkIn] = {{1}};
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).status, -EPIPE);
  say(host_.read(Model::kBulkIn, 64));
  serve(80);
  EXPECT_TRUE(sut_.outbox().empty());
  script_->to_send[Model::kInterruptIn] = {{2}};
  EXPECT_EQ(transfer(host_.read(Model::kInterruptIn, 16), true).data, Bytes{2}) << "another works";
  EXPECT_EQ(transfer(host_.control({0x02, 1, 0, 0, Model::kBulkOut, 0, 0, 0}), false).status, 0);
  EXPECT_TRUE(sut_.outbox().empty()) << "the halt of another was ended";

  say(host_.control({0x02, 1, 0, 0, Model::kBulkIn, 0, 0, 0}));
  serve(8);

  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->status, 0);
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), true)->data, Bytes{1});
}

TEST_F(UsbipSessionTest, AConfigurationThatIsChosenEndsAllHalts) {
  attach();
  script_->stalls_to_come = {Model::kBulkIn, Model::kBulkOut};
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).status, -EPIPE);
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {1}), false).status, -EPIPE);
  EXPECT_EQ(transfer(host_.control({0x00, 9, 1, 0, 0, 0, 0, 0}), false).status, 0);
  script_->to_send[Model::kBulkIn] = {{1}};
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).data, Bytes{1});
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {1}), false).status, 0);
}

TEST_F(UsbipSessionTest, ASettingThatIsChosenEndsTheHaltsOfItsInterfaceAlone) {
  for (bus::UsbEndpointInfo& endpoint : persona_.info.endpoints) {
    endpoint.interface_number = endpoint.address == Model::kBulkIn ? 1 : 0;
  }
  persona_.interfaces = {{.number = 0}, {.number = 1}};
  attach();
  script_->stalls_to_come = {Model::kBulkIn, Model::kBulkOut};
  EXPECT_EQ(transfer(host_.read(Model::kBulkIn, 64), true).status, -EPIPE);
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {1}), false).status, -EPIPE);
  script_->to_send[Model::kBulkIn] = {{1}};
  say(host_.read(Model::kBulkIn, 64));

  EXPECT_EQ(transfer(host_.control({0x01, 11, 0, 0, 2, 0, 0, 0}), false).status, -EPIPE)
      << "it has no such interface";
  EXPECT_EQ(transfer(host_.control({0x01, 11, 0, 0, 0, 0, 0, 0}), false).status, 0);
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {1}), false).status, 0);
  EXPECT_TRUE(sut_.outbox().empty()) << "the halt of the other interface was ended";

  say(host_.control({0x01, 11, 0, 0, 1, 0, 0, 0}));
  serve(8);
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->status, 0);
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), true)->data, Bytes{1});
}

TEST_F(UsbipSessionTest, AnInterruptPipeHasOneTransactionAFrame) {
  attach();
  for (std::uint8_t i = 0; i < 3; ++i) {
    script_->to_send[Model::kInterruptIn].push_back({i});
    say(host_.read(Model::kInterruptIn, 16));
  }
  for (std::uint8_t i = 0; i < 3; ++i) {
    serve(8);
    const auto reply = UsbipHost::take_reply(sut_.outbox(), true);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->data, Bytes{i});
    EXPECT_EQ(reply->seqnum, i + 1U);
    EXPECT_TRUE(sut_.outbox().empty());
  }
}

TEST_F(UsbipSessionTest, MovesNoMoreInAFrameThanFullSpeedCan) {
  attach();
  say(host_.write(Model::kBulkOut, Bytes(6000)));
  serve(8);
  std::size_t bytes = 0;
  for (const Bytes& packet : script_->received[Model::kBulkOut]) bytes += packet.size() + 13;
  EXPECT_GT(bytes, 1000U);
  EXPECT_LE(bytes, 1500U);
  serve(64);
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->actual, 6000U);
}

TEST_F(UsbipSessionTest, AnswersAnUnlinkOnceWhateverItIsAbout) {
  attach();
  say(host_.read(Model::kBulkIn, 64));
  const std::uint32_t waiting = host_.seqnum;
  say(host_.unlink(waiting));
  auto reply = UsbipHost::take_reply(sut_.outbox(), false);
  EXPECT_EQ(reply->command, 4U);
  EXPECT_EQ(reply->seqnum, host_.seqnum);
  EXPECT_EQ(reply->status, -ECONNRESET);
  script_->to_send[Model::kBulkIn] = {{1}};
  serve(8);
  EXPECT_TRUE(sut_.outbox().empty()) << "what was unlinked has no other answer";
  say(host_.unlink(waiting));
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->status, 0);
  say(host_.unlink(4711));
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->status, 0);
  EXPECT_TRUE(sut_.outbox().empty());
}

TEST_F(UsbipSessionTest, CutsOffWhoAsksForTooMuch) {
  attach();
  EXPECT_FALSE(sut_.take(host_.read(Model::kBulkIn, UsbipSession::kMaxTransferBytes + 1)));
}

TEST_F(UsbipSessionTest, CutsOffWhoNeverStopsAsking) {
  attach();
  for (std::size_t i = 0; i < UsbipSession::kMaxTransfers; ++i) {
    ASSERT_TRUE(sut_.take(host_.read(Model::kBulkIn, 64)));
  }
  EXPECT_FALSE(sut_.take(host_.read(Model::kBulkIn, 64)));
}

TEST_F(UsbipSessionTest, CutsOffWhoTakesNoAnswers) {
  attach();
  bool is_up = true;
  for (int i = 0; is_up && i < 200'000; ++i) is_up = sut_.take(host_.unlink(1));
  EXPECT_FALSE(is_up);
}

// A random host: every transfer has one answer, by its end or by an unlink's; every unlink has one.
TEST_F(UsbipSessionTest, EveryMessageOfARandomHostHasItsOneAnswer) {
  attach();
  Dice dice(11);
  std::map<std::uint32_t, bool> open;  // submits; whether data comes back
  std::set<std::uint32_t> unlinks;
  std::set<std::uint32_t> cancelled;
  const std::array<std::uint8_t, 4> endpoints{Model::kBulkIn, Model::kBulkOut, Model::kInterruptIn,
                                              Model::kInterruptOut};
  std::uint32_t last = 0;
  for (int step = 0; step < 5000; ++step) {
    const unsigned what = dice.below(8);
    if (what < 4 && sut_.waiting() < 200) {
      const std::uint8_t endpoint = endpoints[dice.below(4)];
      const bool is_in = bus::is_usb_in(endpoint);
      say(is_in ? host_.read(endpoint, dice.below(200))
                : host_.write(endpoint, Bytes(dice.below(100), 5)));
      open[last = host_.seqnum] = is_in;
    }
    if (what == 4)
      script_->to_send[dice.below(2) == 0 ? Model::kBulkIn : Model::kInterruptIn].push_back(
          Bytes(dice.below(70), 6));
    if (what == 5 && dice.below(20) == 0) script_->stalls_to_come.insert(endpoints[dice.below(4)]);
    if (what == 7 && dice.below(20) == 0) {
      say(host_.control({0x02, 1, 0, 0, endpoints[dice.below(4)], 0, 0, 0}));
      open[last = host_.seqnum] = false;
    }
    if (what == 6) {
      const std::uint32_t victim = 1 + dice.below(last + 1);
      say(host_.unlink(victim));
      unlinks.insert(host_.seqnum);
      if (open.contains(victim)) cancelled.insert(victim);
    }
    serve();
    while (!sut_.outbox().empty()) {
      const std::uint32_t seqnum = UsbipHost::get(sut_.outbox(), 4);
      const auto reply =
          UsbipHost::take_reply(sut_.outbox(), open.contains(seqnum) && open[seqnum]);
      ASSERT_TRUE(reply);
      if (reply->command == 4) {
        EXPECT_EQ(unlinks.erase(seqnum), 1U);
      } else {
        EXPECT_EQ(open.erase(seqnum), 1U);
        EXPECT_FALSE(cancelled.contains(seqnum));
      }
    }
    for (const std::uint32_t seqnum : cancelled) open.erase(seqnum);
  }
  EXPECT_TRUE(unlinks.empty());
  EXPECT_EQ(open.size(), sut_.waiting());
}

TEST_F(UsbipSessionTest, StandsAnyBytes) {
  Dice dice(12);
  for (int i = 0; i < 300; ++i) {
    UsbipSession session(model_, persona_, 8, bench_.surroundings());
    session.set_available(true);
    bool is_up = i % 2 == 0 ? session.take(UsbipHost::import()) : true;
    for (int piece = 0; is_up && piece < 50; ++piece) {
      Bytes bytes =
          dice.below(2) == 0
              ? host_.read(static_cast<std::uint8_t>(dice.below(256)), dice.below(300))
              : host_.write(static_cast<std::uint8_t>(dice.below(16)), Bytes(dice.below(300)));
      for (unsigned flips = dice.below(3); flips > 0; --flips)
        bytes[dice.below(static_cast<std::uint32_t>(bytes.size()))] =
            static_cast<std::uint8_t>(dice.below(256));
      is_up = session.take(bytes);
      session.serve(bench_.clock.now());
    }
    EXPECT_LE(session.waiting(), UsbipSession::kMaxTransfers);
  }
}

}  // namespace
}  // namespace thimble::sim
