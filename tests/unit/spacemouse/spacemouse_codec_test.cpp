#include "drivers/spacemouse/spacemouse_codec.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace thimble::spacemouse {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Axes = std::array<std::int16_t, 3>;

TEST(SpaceMouseCodec, ReadsBothLayouts) {
  const auto moved = parse_report(Bytes{1, 0x5e, 0x01, 0xff, 0xff, 0xa2, 0xfe});
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->translation, (Axes{350, -1, -350}));
  EXPECT_FALSE(moved->rotation);
  const auto turned = parse_report(Bytes{2, 1, 0, 2, 0, 0, 0x80});
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->rotation, (Axes{1, 2, -32768}));
  EXPECT_FALSE(turned->translation);
  const auto both = parse_report(Bytes{1, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0});
  ASSERT_TRUE(both);
  EXPECT_EQ(both->translation, (Axes{1, 2, 3}));
  EXPECT_EQ(both->rotation, (Axes{4, 5, 6}));
}

TEST(SpaceMouseCodec, ReadsAsManyButtonsAsItHasRoomFor) {
  EXPECT_EQ(parse_report(Bytes{3, 0x02})->buttons, 2U);
  EXPECT_EQ(parse_report(Bytes{3, 1, 0, 0, 0x80, 0xff, 0xff})->buttons, 0x80000001U);
}

TEST(SpaceMouseCodec, TakesAReportOfAnotherNumberAsSayingNothing) {
  EXPECT_EQ(parse_report(Bytes{0x17, 64}), PuckReport{});
  EXPECT_EQ(parse_report(Bytes{0}), PuckReport{});
}

TEST(SpaceMouseCodec, SaysWhatTheLengthHasRoomForWhateverTheBytes) {
  std::mt19937 dice(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes(dice() % 20);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(dice());
    if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>(bytes[0] % 5);
    const auto report = parse_report(bytes);
    const std::size_t size = bytes.size();
    const int number = size == 0 ? -1 : bytes[0];
    const bool is_refused = size == 0 || (number == 1 && size != 7 && size != 13) ||
                            (number == 2 && size != 7) || (number == 3 && size == 1);
    ASSERT_EQ(report.has_value(), !is_refused) << number << " " << size;
    if (!report) continue;
    EXPECT_EQ(report->translation.has_value(), number == 1);
    EXPECT_EQ(report->rotation.has_value(), number == 2 || (number == 1 && size == 13));
    EXPECT_EQ(report->buttons.has_value(), number == 3);
  }
}

}  // namespace
}  // namespace thimble::spacemouse
