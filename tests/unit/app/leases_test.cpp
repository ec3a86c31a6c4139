#include "daemon/app/leases.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace thimble::app {
namespace {

using Holder = Leases::Holder;

Leases two_arms() { return Leases({{"left", false}, {"right", true}}); }

TEST(Leases, AConfiguredArmHoldsItsOwn) {
  const Leases sut = two_arms();
  EXPECT_EQ(sut.holder(0), Holder::Nobody);
  EXPECT_EQ(sut.holder(1), Holder::Configuration);
}

TEST(Leases, AnArmActivatedOverTheApiIsReleasedWithItsConnection) {
  Leases sut = two_arms();
  ASSERT_TRUE(sut.acquire("left", 7)->is_bound_to_connection);
  EXPECT_EQ(sut.drop_client(8).size(), 0U);
  EXPECT_EQ(sut.drop_client(7), std::vector<std::string>{"left"});
  EXPECT_EQ(sut.holder(0), Holder::Nobody);
}

TEST(Leases, AConfiguredLeaseIsTakenUpAgainAndOutlivesTheConnection) {
  Leases sut = two_arms();
  ASSERT_TRUE(sut.release("right"));
  ASSERT_EQ(sut.holder(1), Holder::Nobody);
  ASSERT_FALSE(sut.acquire("right", 7)->is_bound_to_connection);
  EXPECT_TRUE(sut.drop_client(7).empty());
  EXPECT_EQ(sut.holder(1), Holder::Configuration);
}

TEST(Leases, ASecondHolderIsRefusedAndTheFirstMayAskAgain) {
  Leases sut = two_arms();
  ASSERT_TRUE(sut.acquire("left", 7));
  EXPECT_EQ(sut.acquire("left", 8).error().code, Errc::Busy);
  EXPECT_TRUE(sut.acquire("left", 7));
}

TEST(Leases, ALeaseIsHeldForItsClientOnlyAndTheConfigurationsForAll) {
  Leases sut = two_arms();
  EXPECT_FALSE(sut.is_held_for(0, 0));
  ASSERT_TRUE(sut.acquire("left", 7));
  EXPECT_TRUE(sut.is_held_for(0, 7));
  EXPECT_FALSE(sut.is_held_for(0, 8));
  EXPECT_TRUE(sut.is_held_for(1, 8));
}

TEST(Leases, AnUnknownArmIsNamed) {
  Leases sut = two_arms();
  EXPECT_NE(sut.acquire("middle", 1).error().message.find("middle"), std::string::npos);
  EXPECT_EQ(sut.release("middle").error().code, Errc::NotFound);
}

TEST(Leases, NoTwoLeasesOfClientsHaveTheSameNumberAndOneKeepsIts) {
  std::mt19937 random(5);
  Leases sut({{"a", false}, {"b", false}, {"c", true}});
  std::map<std::string, std::uint64_t> oracle;
  std::uint64_t last = 0;
  for (int step = 0; step < 20'000; ++step) {
    const std::string arm(1, static_cast<char>('a' + random() % 3));
    const std::size_t index = sut.find(arm).value();
    const Leases::Client client = 1 + random() % 3;
    if (random() % 3 == 0) {
      ASSERT_TRUE(sut.release(arm));
      oracle.erase(arm);
    } else if (sut.acquire(arm, client) && arm != "c" && oracle.count(arm) == 0) {
      ASSERT_GT(sut.number(index), last);
      oracle[arm] = last = sut.number(index);
    }
    for (const std::string name : {"a", "b", "c"}) {
      const std::uint64_t expected = oracle.count(name) == 0 ? 0 : oracle[name];
      ASSERT_EQ(sut.number(sut.find(name).value()), expected) << step << ' ' << name;
    }
  }
}

TEST(Leases, RandomProgramsNeverLeaveAnArmWithAClientThatIsGone) {
  std::mt19937 random(4);
  Leases sut({{"a", false}, {"b", false}});
  std::map<std::string, Leases::Client> oracle;
  for (int step = 0; step < 20'000; ++step) {
    const Leases::Client client = 1 + random() % 3;
    const std::string arm = random() % 2 == 0 ? "a" : "b";
    switch (random() % 3) {
      case 0: {
        const bool is_free = oracle.count(arm) == 0 || oracle[arm] == client;
        ASSERT_EQ(sut.acquire(arm, client).has_value(), is_free);
        if (is_free) oracle[arm] = client;
        break;
      }
      case 1:
        ASSERT_TRUE(sut.release(arm));
        oracle.erase(arm);
        break;
      default:
        ASSERT_EQ(sut.drop_client(client).size(),
                  static_cast<std::size_t>(std::erase_if(
                      oracle, [&](const auto& held) { return held.second == client; })));
    }
    ASSERT_EQ(sut.holder(0) == Holder::Client, oracle.count("a") == 1);
    ASSERT_EQ(sut.holder(1) == Holder::Client, oracle.count("b") == 1);
  }
}

}  // namespace
}  // namespace thimble::app
