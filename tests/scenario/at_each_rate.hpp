#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/closed_loop.hpp"

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

// How many exchanges such a loop has in that time: no more than its servo asks for.
[[nodiscard]] inline std::uint64_t exchanges_within(Duration time, ClosedLoop& loop) {
  return static_cast<std::uint64_t>(time / loop.settings().freshness.exchange_period);
}

}  // namespace thimble::test

#define THIMBLE_AT_EACH_RATE(Suite)                                         \
  INSTANTIATE_TEST_SUITE_P(, Suite, testing::Values(500, 1000, 4000, 8000), \
                           [](const auto& of) { return std::to_string(of.param) + "Hz"; })
