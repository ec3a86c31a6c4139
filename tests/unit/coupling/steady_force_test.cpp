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
  sut.hold(-2.5);
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
TEST(SteadyForce, IsLetGoWhereNobodyKeepsItAndDoesNotComeBack) {
  int resets = 0;
  SteadyForce sut(std::make_unique<Below>(resets));
  const auto force_at = [&](int ms) {
    ArmInput input;
    input.now = MonotonicTime{std::chrono::milliseconds(ms)};
    return sut.step(input).force;
  };
  const Force3 held{0, -2.5, 0};
  const Force3 of_the_world{1, 2, 3};
  force_at(1000);  // some time after the start
  sut.hold(-2.5);
  EXPECT_EQ(force_at(1001), held);
  EXPECT_EQ(force_at(1250), held);
  sut.keep();
  EXPECT_EQ(force_at(1251), held);
  EXPECT_EQ(force_at(1500), held);
  EXPECT_EQ(resets, 0);
  EXPECT_EQ(force_at(1501), of_the_world);
  EXPECT_EQ(resets, 1) << "the ghost is at the hand";
  sut.keep();
  EXPECT_EQ(force_at(1502), of_the_world) << "by whoever was late";
  sut.hold(-2.5);
  EXPECT_EQ(force_at(1503), held) << "another one";
  sut.hold(-1);
  EXPECT_EQ(force_at(1504), (Force3{0, -1, 0}));
  EXPECT_EQ(resets, 1);
}

}  // namespace
}  // namespace thimble::coupling
