#include "daemon/coupling/steady_force.hpp"

#include <gtest/gtest.h>

namespace thimble::coupling {
namespace {

struct Below final : ArmCoupling {
  explicit Below(int& resets) : resets_(resets) {}
  void restart(MonotonicTime, Position3) noexcept override { ++resets_; }
  ArmOutput advance(const ArmInput&) noexcept override {
    ArmOutput out;
    out.force = {1, 2, 3};
    out.new_contacts = 4;
    return out;
  }
  int& resets_;
};

TEST(SteadyForce, IsNothingUntilItIsHeldAndEndsWithTheGhostAtTheHand) {
  int resets = 0;
  SteadyForce sut(std::make_unique<Below>(resets));
  EXPECT_EQ(sut.step({}).force, (Force3{1, 2, 3}));
  sut.hold(-2.5, MonotonicTime{std::chrono::seconds(1)});
  const ArmOutput out = sut.step({});
  EXPECT_EQ(out.force, (Force3{0, -2.5, 0}));
  EXPECT_EQ(out.new_contacts, 4U) << "the rest is the world's";
  EXPECT_EQ(resets, 0);
  sut.release();
  EXPECT_EQ(sut.step({}).force, (Force3{1, 2, 3}));
  EXPECT_EQ(resets, 1);
  sut.step({});
  EXPECT_EQ(resets, 1);
  sut.reset({}, {});
  EXPECT_EQ(resets, 2);
}

// Of a control thread that hangs.
TEST(SteadyForce, IsLetGoWhereNobodyKeepsIt) {
  int resets = 0;
  SteadyForce sut(std::make_unique<Below>(resets));
  const auto at = [](int ms) {
    ArmInput input;
    input.now = MonotonicTime{std::chrono::milliseconds(ms)};
    return input;
  };
  const Force3 held{0, -2.5, 0};
  sut.hold(-2.5, at(100).now);
  EXPECT_EQ(sut.step(at(99)).force, held);
  sut.keep(at(200).now);
  EXPECT_EQ(sut.step(at(199)).force, held);
  EXPECT_EQ(resets, 0);
  EXPECT_EQ(sut.step(at(200)).force, (Force3{1, 2, 3}));
  EXPECT_EQ(resets, 1) << "the ghost is at the hand";
  EXPECT_EQ(sut.step(at(1000)).force, (Force3{1, 2, 3}));
}

}  // namespace
}  // namespace thimble::coupling
