#include "sim/time/trace_hash.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace thimble::sim {
namespace {

std::uint64_t hash_of(std::string_view text) {
  TraceHash sut;
  sut.add(std::vector<std::uint8_t>(text.begin(), text.end()));
  return sut.value();
}

// Test vectors of the authors' FNV page.
TEST(TraceHash, MatchesThePublishedVectors) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325U);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8U);
}

TEST(TraceHash, IntegersAreTheirLittleEndianBytes) {
  TraceHash sut;
  sut.add(std::uint32_t{0x64636261});
  EXPECT_EQ(sut.value(), hash_of("abcd"));
}

TEST(TraceHash, NegativeNumbersKeepTheirWidth) {
  TraceHash sut;
  sut.add(std::int16_t{-1});
  EXPECT_EQ(sut.value(), hash_of("\xff\xff"));
}

TEST(TraceHash, DoublesDifferByAnyBit) {
  TraceHash positive;
  TraceHash negative;
  positive.add(0.0);
  negative.add(-0.0);
  EXPECT_NE(positive.value(), negative.value());
}

}  // namespace
}  // namespace thimble::sim
