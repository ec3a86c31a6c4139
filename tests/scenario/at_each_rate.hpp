#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace thimble::test {

// The rates that issue and design promise, for tests that must hold at each.
class AtEachRate : public testing::TestWithParam<int> {
 protected:
  // `more` on top of the rate.
  [[nodiscard]] static std::vector<std::string> with(std::vector<std::string> more = {}) {
    more.push_back("servo.rate_hz=" + std::to_string(GetParam()));
    return more;
  }
};

}  // namespace thimble::test

#define THIMBLE_AT_EACH_RATE(Suite)                                         \
  INSTANTIATE_TEST_SUITE_P(, Suite, testing::Values(500, 1000, 4000, 8000), \
                           [](const auto& of) { return std::to_string(of.param) + "Hz"; })
