#include "drivers/falcon/falcon_wire.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

namespace thimble::falcon::wire {
namespace {

// The FT232's reference is 3 MHz; the upper bits of the divisor are eighths, 0b01 in bits 14 and 15
// meaning a half.
TEST(FalconWire, DivisorsGiveTheRatesThatTheyAreNamedAfter) {
  constexpr double kReference_hz = 3e6;
  const double half = (kDivisor9600 >> 14) == 1 ? 0.5 : 0;
  EXPECT_NEAR(kReference_hz / ((kDivisor9600 & 0x3fff) + half), 9600, 0.5);
  EXPECT_NEAR(kReference_hz / kDivisorUpload, 142'857, 1);
  EXPECT_NEAR(kReference_hz / (kDivisorRun & 0x3fff), 1.5e6, 1);
}

TEST(FalconWire, NumbersFlagsAndFrameFillThePacketWithoutOverlap) {
  EXPECT_EQ(kFirstNumberByte + 3 * kNibblesPerNumber, kFlagsByte);
  EXPECT_EQ(kFlagsByte + 1, kUnknownByte);
  EXPECT_EQ(kUnknownByte + 2, kRunBytes);
}

TEST(FalconWire, FlagsDoNotOverlap) {
  EXPECT_EQ(kHomed[0] | kHomed[1] | kHomed[2], kAllHomed);
  EXPECT_EQ(kAllHomed & kButtons, 0);
  EXPECT_EQ(kButtonRight | kButtonForward | kButtonCentre | kButtonLeft, kButtons);
  EXPECT_EQ(kHomingOn + kLedGreen + kLedBlue + kLedRed, 0x0f);
}

TEST(FalconWire, AChunkOfTheImageComesBackInOnePacket) {
  EXPECT_LE(kUploadChunkBytes, kMaxPayloadBytes);
  EXPECT_LE(kUploadChunkBytes, kUsbPacketBytes);
}

TEST(FalconWire, SumsOfImagesAreSha256InSmallHexadecimal) {
  for (const FirmwareImage& image : kKnownImages) {
    EXPECT_EQ(image.sha256.size(), 64U) << image.file;
    EXPECT_EQ(image.sha256.find_first_not_of("0123456789abcdef"), std::string_view::npos)
        << image.file;
  }
}

}  // namespace
}  // namespace thimble::falcon::wire
