#include "daemon/coupling/energy_observer.hpp"

#include <gtest/gtest.h>

#include "hand_samples.hpp"

namespace thimble::coupling {
namespace {

using testing::kTick;

TEST(EnergyObserver, SpringGivesBackWhatItTookAndGeneratesNothing) {
  EnergyObserver sut;
  for (int i = 0; i < 100; ++i) sut.add({-1, 0, 0}, {0.1, 0, 0}, kTick);
  EXPECT_NEAR(sut.given_joule(), -0.01, 1e-12);
  for (int i = 0; i < 100; ++i) sut.add({-1, 0, 0}, {-0.1, 0, 0}, kTick);
  EXPECT_NEAR(sut.given_joule(), 0, 1e-12);
  EXPECT_NEAR(sut.generated_joule(), 0, 1e-12);
}

TEST(EnergyObserver, RemembersTheMostThatWasGenerated) {
  EnergyObserver sut;
  sut.add({0, 2, 0}, {0, 0.5, 0}, kTick);
  sut.add({0, 2, 0}, {0, -5, 0}, kTick);
  EXPECT_NEAR(sut.generated_joule(), 0.001, 1e-12);
  EXPECT_NEAR(sut.given_joule(), -0.009, 1e-12);
}

}  // namespace
}  // namespace thimble::coupling
