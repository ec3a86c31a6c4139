#include <gtest/gtest.h>

#include <set>

#include "tests/unit/link/thimble_table.hpp"

// What a peer without the key, with a capture, or with nothing but bandwidth may do.

namespace thimble::link {
namespace {

using on_table::Arm;
using on_table::at_port;
using on_table::Carried;
using on_table::keyed_arm;
using on_table::keyed_world;
using on_table::Table;

TEST(ThimbleLinkHostile, AWrongKeyOpensNothingAndHearsNothing) {
  for (const auto& [world, arm_settings] : {std::pair(keyed_world(1), keyed_arm(2)),
                                            std::pair(keyed_world(1), ThimbleArmEnd::Settings()),
                                            std::pair(ThimbleWorldEnd::Settings(), keyed_arm(1))}) {
    Table table(world);
    Arm& arm = table.add_arm(arm_settings);
    table.run(3000);
    EXPECT_TRUE(arm.replies.empty());
    EXPECT_EQ(table.sent_by_world(), 0U);
    EXPECT_TRUE(table.worlds.empty());
    EXPECT_EQ(table.world->total().rejected(RejectReason::BadSeal), table.carried.size());
    EXPECT_EQ(table.carried.size(), 12U);  // a question each 250 ms
  }
}

TEST(ThimbleLinkHostile, ACaptureThatIsPlayedAgainOpensNothing) {
  Table table(keyed_world());
  Arm& arm = table.add_arm(keyed_arm());
  table.run(200);
  const std::vector<Carried> capture = table.carried;
  const std::size_t felt = table.worlds.at(0)->samples.size();
  for (const Carried& datagram : capture) table.deliver(arm.place, datagram.datagram.view());
  for (const Carried& datagram : capture) table.deliver(at_port(666), datagram.datagram.view());
  EXPECT_EQ(table.worlds.size(), 1U);  // while the session stands …
  EXPECT_EQ(table.worlds[0]->samples.size(), felt);
  arm.is_running = false;
  table.run(1500);
  EXPECT_TRUE(table.world->sessions().empty());
  for (int minute = 0; minute < 2; ++minute) {
    for (const Carried& datagram : capture) table.deliver(arm.place, datagram.datagram.view());
    for (const Carried& datagram : capture) table.deliver(at_port(666), datagram.datagram.view());
    EXPECT_TRUE(table.world->sessions().empty());  // … and when it is over
    table.run(10000);
  }
  EXPECT_EQ(table.worlds.size(), 1U);
  arm.is_running = true;
  table.run(100);
  EXPECT_EQ(table.worlds.size(), 2U);
}

TEST(ThimbleLinkHostile, AnArmTakesNothingOfAnotherSessionsCapture) {
  Table table(keyed_world());
  Arm& arm = table.add_arm(keyed_arm());
  table.run(200);
  const std::vector<Carried> capture = table.carried;
  arm.is_running = false;
  table.run(1500);
  arm.is_running = true;
  table.step();
  const auto play = [&] {
    for (const Carried& datagram : capture)
      arm.end.on_datagram(datagram.datagram.view(), table.now());
  };
  arm.replies.clear();
  play();
  table.step();
  EXPECT_EQ(arm.replies.size(), 0U);
  table.run(50);
  const std::size_t before = arm.replies.size();
  play();
  table.step();
  EXPECT_EQ(arm.replies.size(), before + 1);  // the table's own
}

TEST(ThimbleLinkHostile, NobodyIsAnsweredWithMoreThanHeSent) {
  for (const bool has_key : {false, true}) {
    Table table(has_key ? keyed_world() : ThimbleWorldEnd::Settings());
    table.add_arm(has_key ? keyed_arm() : ThimbleArmEnd::Settings());
    ThimbleArmEnd::Settings odd = has_key ? keyed_arm() : ThimbleArmEnd::Settings();
    odd.half.scheme = ShortName::of("unheard-of");
    table.add_arm(odd);
    table.run(20);
    std::set<ThimbleKind> kinds;
    for (std::size_t i = 0; i + 1 < table.carried.size(); ++i) {
      const Carried& asked = table.carried[i];
      const Carried& answer = table.carried[i + 1];
      const auto kind = decode_header(answer.datagram.view())->kind;
      if (!asked.is_to_world || answer.is_to_world || kind >= ThimbleKind::Sample) continue;
      kinds.insert(kind);
      EXPECT_LE(answer.datagram.size, asked.datagram.size);
    }
    EXPECT_EQ(kinds.size(), 3U);
  }
}

TEST(ThimbleLinkHostile, AFloodOfNoiseIsCountedAndStallsNobody) {
  const auto replies_with = [](int noise_a_step) {
    Table table(keyed_world());
    Arm& arm = table.add_arm(keyed_arm());
    RandomBytes random = on_table::seeded_random(77);
    std::size_t noise = 0;
    for (int i = 0; i < 300; ++i) {
      table.step();
      for (int k = 0; k < noise_a_step; ++k) {
        ThimbleDatagram datagram = table.carried[noise % table.carried.size()].datagram;
        random(std::span(datagram.bytes).subspan(6, datagram.size - 6));  // kind and magic hold
        if (k % 3 == 0) random(std::span(datagram.bytes).first(datagram.size));
        const std::size_t sent = table.sent_by_world();
        table.deliver(k % 2 == 0 ? arm.place : at_port(666), datagram.view());
        arm.end.on_datagram(datagram.view(), table.now());
        EXPECT_EQ(table.sent_by_world(), sent);
        ++noise;
      }
    }
    const LinkCounters counters = table.world->total();
    EXPECT_EQ(counters.rejected() + counters.stale, noise);
    EXPECT_EQ(table.worlds.size(), 1U);
    return arm.replies.size();
  };
  EXPECT_EQ(replies_with(40), replies_with(0));
}

TEST(ThimbleLinkHostile, OnlyThePinnedAddressIsHeard) {
  ThimbleWorldEnd::Settings world = keyed_world();
  world.pinned_peer = at_port(0);
  world.pinned_peer->address[3] = 9;
  Table table(world);
  table.add_arm(keyed_arm());
  table.run(500);
  EXPECT_EQ(table.sent_by_world(), 0U);
  EXPECT_EQ(table.world->total().rejected(RejectReason::WrongPeer), table.carried.size());
}

}  // namespace
}  // namespace thimble::link
