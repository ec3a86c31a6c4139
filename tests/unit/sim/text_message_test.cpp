#include "sim/model/arm/text_message.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>
#include <random>
#include <string>

namespace thimble::sim {
namespace {

using Currents = std::optional<std::array<std::int32_t, 3>>;

// What the board's source does; it takes numbers that fit only, as no others are defined.
Currents scanned(const std::string& message) {
  std::array<std::int32_t, 3> all{};
  const int found = std::sscanf(message.c_str(), "[%d,%d,%d]", &all[0], &all[1], &all[2]);
  return found == 3 ? Currents(all) : std::nullopt;
}

TEST(TextMessage, ReadsThreeNumbers) {
  EXPECT_EQ(scan_currents("[1,-2,+3]"), (Currents({1, -2, 3})));
  EXPECT_EQ(scan_currents("[ 1,\t-2,\n+03"), (Currents({1, -2, 3})));
  EXPECT_EQ(scan_currents("[1,2,3x"), (Currents({1, 2, 3}))) << "what is behind is not looked at";
  for (const char* none : {"", "[", "[1,2", "[1,2,", "[1,2,-]", "1,2,3]", " [1,2,3]", "[1 ,2,3]",
                           "[1,2,- 3]", "[--1,2,3]", "[a,b,c]"}) {
    EXPECT_EQ(scan_currents(none), std::nullopt) << none;
  }
}

TEST(TextMessage, ANumberBeyondAllIsTheLargest) {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min();
  EXPECT_EQ(scan_currents("[2147483647,-2147483648,2147483648]"),
            (Currents({kMost, kLeast, kMost})));
  EXPECT_EQ(scan_currents("[-2147483649,99999999999999999999999999999,-99999999999999999999999]"),
            (Currents({kLeast, kMost, kLeast})));
}

TEST(TextMessage, AnyLettersAreReadAsTheBoardReadsThem) {
  constexpr std::string_view kLetters = "[,,,--+ 0123456789\n]x";
  std::mt19937 random(11);
  int read = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::string message = "[12,-7,305]";
    for (std::size_t changes = random() % 5; changes > 0; --changes) {
      const char letter = kLetters[random() % kLetters.size()];
      const std::size_t at = random() % message.size();
      if (random() % 2 == 0) message[at] = letter;
      if (random() % 3 == 0) message.insert(at, 1, letter);
    }
    const Currents expected = scanned(message);
    if (expected) ++read;
    ASSERT_EQ(scan_currents(message), expected) << message;
  }
  EXPECT_GT(read, 10'000);
}

}  // namespace
}  // namespace thimble::sim
