#include "daemon/link/outstanding_requests.hpp"

#include <gtest/gtest.h>

namespace thimble::link {
namespace {

constexpr MonotonicTime at(std::uint64_t index) {
  return {std::chrono::microseconds(125) * static_cast<std::int64_t>(index)};  // 8 kHz
}

TEST(OutstandingRequests, MoreThanThereIsRoomForForgetsTheOldestAndCountsThemAsLost) {
  OutstandingRequests sut;
  constexpr std::uint64_t kRoom = OutstandingRequests::kCapacity;
  constexpr std::uint64_t kTooMany = 10;

  for (std::uint64_t i = 0; i < kRoom + kTooMany; ++i) sut.on_sent(at(i));

  EXPECT_EQ(sut.size(), kRoom);
  EXPECT_EQ(sut.lost(), kTooMany);
  const MonotonicTime now = at(kRoom + kTooMany);
  EXPECT_EQ(sut.on_reply(now), now - at(kTooMany)) << "the oldest that is left is answered";
  EXPECT_EQ(sut.size(), kRoom - 1);
}

TEST(OutstandingRequests, WhatIsOpenWhenAllIsForgottenIsLostAndIsAnsweredByNothing) {
  OutstandingRequests sut;
  for (std::uint64_t i = 0; i < 5; ++i) sut.on_sent(at(i));

  sut.forget();

  EXPECT_EQ(sut.size(), 0U);
  EXPECT_EQ(sut.lost(), 5U);
  EXPECT_FALSE(sut.on_reply(at(6)));
}

}  // namespace
}  // namespace thimble::link
