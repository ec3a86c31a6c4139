#include "daemon/api/seats.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace thimble::api {
namespace {

constexpr UserId kAnn = 1000;
constexpr UserId kBob = 1001;

TEST(Seats, TheLongestSilentOfOneUserGoes) {
  EXPECT_EQ(who_goes({{{1}, kAnn, 5}, {{2}, kAnn, 3}, {{3}, kAnn, 4}}, kAnn), ClientId{2});
}

TEST(Seats, WhoHoldsALeaseStays) {
  EXPECT_EQ(who_goes({{{1}, kAnn, 1, true}, {{2}, kAnn, 2}}, kAnn), ClientId{2});
  EXPECT_EQ(who_goes({{{1}, kAnn, 1, true}, {{2}, kBob, 2, true}}, kAnn), std::nullopt);
}

TEST(Seats, WhoHasManyMakesRoomForWhoHasFew) {
  const std::vector<Seat> seats{{{1}, kBob, 1}, {{2}, kAnn, 2}, {{3}, kAnn, 3}};
  EXPECT_EQ(who_goes(seats, kAnn), ClientId{2}) << "not Bob's only one, silent as it is";
  EXPECT_EQ(who_goes(seats, 0), ClientId{2});
}

TEST(Seats, WhoWouldHaveMostByComingMakesRoomAlone) {
  EXPECT_EQ(who_goes({{{1}, kAnn, 1}, {{2}, kBob, 2}}, kBob), ClientId{2});
}

// However the others come, move and take leases, a user who keeps no more than an equal share of
// the seats that leases leave loses none of it.
TEST(Seats, NobodyLosesAnEqualShareToOthers) {
  constexpr std::size_t kRoom = 12;
  constexpr std::size_t kLeases = 2;
  constexpr std::size_t kShare = (kRoom - kLeases) / 3;  // three users
  constexpr UserId kQuiet = 7;
  std::mt19937 random(406);
  std::vector<Seat> seats;
  std::uint64_t now = 0;
  for (std::uint64_t i = 0; i < kShare; ++i) seats.push_back({{i}, kQuiet, ++now});
  for (std::uint64_t i = 100; i < 20'000; ++i) {
    const UserId user = random() % 3 == 0 ? kAnn : kBob;
    if (seats.size() == kRoom) {
      const auto goes = who_goes(seats, user);
      ASSERT_TRUE(goes);
      ASSERT_GE(goes->value, 100U) << "one of the quiet user's";
      const auto gone = std::find_if(seats.begin(), seats.end(),
                                     [&](const Seat& seat) { return seat.client == *goes; });
      ASSERT_NE(gone, seats.end());
      ASSERT_FALSE(gone->holds_lease);
      seats.erase(gone);
    }
    seats.push_back({{i}, user, ++now});
    Seat& other = seats[kShare + random() % (seats.size() - kShare)];
    other.moved = ++now;
    const auto leases = std::count_if(seats.begin(), seats.end(),
                                      [](const Seat& seat) { return seat.holds_lease; });
    other.holds_lease = leases < static_cast<std::ptrdiff_t>(kLeases) && random() % 5 == 0;
  }
}

}  // namespace
}  // namespace thimble::api
