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

}  // namespace
}  // namespace thimble::cli
