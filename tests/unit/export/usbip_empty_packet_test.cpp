#include <gtest/gtest.h>

#include <cerrno>
#include <vector>

#include "tests/unit/export/usbip_session_fixture.hpp"

namespace thimble::sim {
namespace {

TEST_F(UsbipSessionTest, AnEmptyWriteIsOneEmptyPacket) {
  attach();
  for (const std::uint8_t endpoint : {Model::kBulkOut, Model::kInterruptOut}) {
    const auto reply = transfer(host_.write(endpoint, {}), false);
    EXPECT_EQ(reply.status, 0);
    EXPECT_EQ(reply.actual, 0U);
    EXPECT_EQ(script_->received[endpoint], std::vector<Bytes>{{}});
  }
}

TEST_F(UsbipSessionTest, AnEmptyWriteWaitsForADeviceThatTakesNothingAndMayStall) {
  attach();
  script_->deaf.insert(Model::kBulkOut);
  say(host_.write(Model::kBulkOut, {}));
  serve(100);
  EXPECT_TRUE(sut_.outbox().empty());
  script_->deaf.clear();
  serve();
  EXPECT_EQ(UsbipHost::take_reply(sut_.outbox(), false)->status, 0);
  EXPECT_EQ(script_->received[Model::kBulkOut].size(), 1U);
  script_->stalls_to_come.insert(Model::kBulkOut);
  EXPECT_EQ(transfer(host_.write(Model::kBulkOut, {}), false).status, -EPIPE);
}

TEST_F(UsbipSessionTest, AnEmptyPacketEndsAWriteOfWholePacketsWhereTheHostAsksForIt) {
  constexpr std::uint32_t kZeroPacket = 0x40;
  attach();
  for (const std::size_t size : {1U, 63U, 64U, 65U, 127U, 128U}) {
    for (const std::uint32_t flags : {0U, kZeroPacket}) {
      auto& packets = script_->received[Model::kBulkOut];
      packets.clear();
      const auto reply = transfer(
          host_.submit({.endpoint = Model::kBulkOut, .flags = flags, .data = Bytes(size, 7)}),
          false);
      EXPECT_EQ(reply.status, 0);
      EXPECT_EQ(reply.actual, size);
      const bool ends_empty = flags == kZeroPacket && size % 64 == 0;
      ASSERT_EQ(packets.size(), (size + 63) / 64 + (ends_empty ? 1 : 0)) << size;
      EXPECT_EQ(packets.back().empty(), ends_empty) << size;
    }
  }
}

}  // namespace
}  // namespace thimble::sim
