#include "cli/ask.hpp"

#include <gtest/gtest.h>

#include "cli/text.hpp"
#include "tests/unit/cli/sample_status.hpp"

namespace thimble::cli {
namespace {

struct FindWorld : testing::Test {
  api::Status status = sample_status();

  void add_second() {
    status.worlds.push_back(status.worlds.front());
    status.worlds.back().name = "pond\x1b";
  }
  std::string refusal_of(const std::string& name) {
    const auto found = find_world(status, name);
    EXPECT_FALSE(found) << name;
    return found ? "" : found.error().message;
  }
};

TEST_F(FindWorld, TheOneOfTheNameIsFoundAmongSeveral) {
  add_second();
  const auto sut = find_world(status, "box");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->source, "box:3");
}

TEST_F(FindWorld, TheOnlyOneNeedsNoName) {
  const auto sut = find_world(status, "");
  ASSERT_TRUE(sut);
  EXPECT_EQ(sut->name, "box");
}

TEST_F(FindWorld, WhatIsNotFoundNamesThoseThatAreThereAsATerminalMayShowThem) {
  EXPECT_EQ(refusal_of("bin"), "there is no world bin, but box");
  add_second();
  EXPECT_EQ(refusal_of(""), "say which world: box, " + plain("pond\x1b"));
  status.worlds.clear();
  EXPECT_EQ(refusal_of(""), "this daemon has no world");
  EXPECT_EQ(refusal_of("box"), "this daemon has no world");
}

TEST(ArmThatAsks, IsNamedWhereNoWorldIsOrTheOnlyOneWhereThereIsNoWorld) {
  api::Status status = sample_status();
  status.arms.resize(1);
  status.arms.front().name = "right";
  EXPECT_EQ(arm_that_asks(status, "free", "right"), "right");
  EXPECT_EQ(arm_that_asks(status, "reset", "right"), "right");
  EXPECT_EQ(arm_that_asks(status, "select", "right"), std::nullopt) << "by its buttons";
  EXPECT_EQ(arm_that_asks(status, "free", "box"), std::nullopt);
  EXPECT_EQ(arm_that_asks(status, "free", ""), std::nullopt) << "the only world is meant";
  status.arms.front().name = "box";
  EXPECT_EQ(arm_that_asks(status, "free", "box"), std::nullopt) << "worlds come first";
  status.worlds.clear();
  EXPECT_EQ(arm_that_asks(status, "free", ""), "box");
  EXPECT_EQ(arm_that_asks(status, "free", "left"), std::nullopt);
  status.arms.push_back(status.arms.front());
  EXPECT_EQ(arm_that_asks(status, "free", ""), std::nullopt) << "which one?";
}

}  // namespace
}  // namespace thimble::cli
