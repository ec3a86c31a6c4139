#include "hal/base/contain.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>

namespace thimble {
namespace {

TEST(Contain, AWorkThatGivesNothingIsDone) {
  bool is_done = false;
  const Result<void> sut = contain([&] { is_done = true; });
  EXPECT_TRUE(sut.has_value());
  EXPECT_TRUE(is_done);
}

TEST(Contain, WhatAWorkGivesIsHandedOn) {
  const Result<std::unique_ptr<int>> sut = contain([] { return std::make_unique<int>(7); });
  ASSERT_TRUE(sut.has_value());
  EXPECT_EQ(**sut, 7);
}

TEST(Contain, AWorkThatCanFailKeepsItsOwnErrorAndItsValue) {
  const auto work = [](bool is_well) -> Result<int> {
    if (is_well) return 7;
    return fail(Errc::Busy, "held");
  };
  EXPECT_EQ(contain([&] { return work(true); }), Result<int>(7));
  const Result<int> sut = contain([&] { return work(false); });
  ASSERT_FALSE(sut.has_value());
  EXPECT_EQ(sut.error(), (Error{Errc::Busy, "held"}));
}

TEST(Contain, WhatIsThrownIsAnErrorWithItsWords) {
  const Result<void> sut = contain([] { throw std::runtime_error("no memory"); });
  ASSERT_FALSE(sut.has_value());
  EXPECT_EQ(sut.error(), (Error{Errc::System, "no memory"}));
  const Result<int> other = contain([]() -> Result<int> { throw std::string("odd"); });
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().code, Errc::System);
}

}  // namespace
}  // namespace thimble
