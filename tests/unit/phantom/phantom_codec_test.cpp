#include "drivers/phantom/phantom_codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace thimble::phantom {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const HostReport& report) {
  return {report.payload().begin(), report.payload().end()};
}

Bytes padded(Bytes bytes) {
  bytes.resize(wire::kTeensyReportBytes, 0);
  return bytes;
}

// Written by hand from the protocol sheet: a 1, b -1, c 258, d -32768, e 32767, f 5, info 1.
const Bytes kGolden = {0x01, 0x00, 0xff, 0xff, 0x02, 0x01, 0x00,
                       0x80, 0xff, 0x7f, 0x05, 0x00, 0x01, 0x00};

TEST(PhantomCodec, ParsesAReportWrittenByHand) {
  DeviceReport expected;
  expected.base_counts = {1, -1, 258};
  expected.gimbal_counts = {-32768, 32767, 5};
  expected.is_calibration_pressed = true;
  EXPECT_EQ(parse_device_report(kGolden, ReportForm::Mbed), expected);
  EXPECT_EQ(parse_device_report(padded(kGolden), ReportForm::Teensy), expected);
}

TEST(PhantomCodec, IgnoresPaddingAndUnknownInfoBits) {
  Bytes bytes = padded(kGolden);
  bytes[12] = 0xfe;
  bytes[13] = 0xff;
  for (std::size_t i = 14; i < bytes.size(); ++i) bytes[i] = 0xaa;
  const auto report = parse_device_report(bytes, ReportForm::Teensy);
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->is_calibration_pressed);
  EXPECT_EQ(report->base_counts[2], 258);
}

TEST(PhantomCodec, TakesTheStylusButtonOutOfEncoderDInTheTeensyFormOnly) {
  const auto parse_d = [](std::uint8_t low, std::uint8_t high, ReportForm form) {
    Bytes bytes(report_bytes(form), 0);
    bytes[6] = low;
    bytes[7] = high;
    return *parse_device_report(bytes, form);
  };
  // 5000 is not pressed, 5001 is: -4999 counts; 10030 is 30 counts.
  EXPECT_FALSE(parse_d(0x88, 0x13, ReportForm::Teensy).is_stylus_pressed);
  EXPECT_EQ(parse_d(0x88, 0x13, ReportForm::Teensy).gimbal_counts[0], 5000);
  EXPECT_TRUE(parse_d(0x89, 0x13, ReportForm::Teensy).is_stylus_pressed);
  EXPECT_EQ(parse_d(0x89, 0x13, ReportForm::Teensy).gimbal_counts[0], -4999);
  EXPECT_EQ(parse_d(0x2e, 0x27, ReportForm::Teensy).gimbal_counts[0], 30);
  EXPECT_FALSE(parse_d(0x2e, 0x27, ReportForm::Mbed).is_stylus_pressed);
  EXPECT_EQ(parse_d(0x2e, 0x27, ReportForm::Mbed).gimbal_counts[0], 10030);
}

TEST(PhantomCodec, RefusesEveryOtherLength) {
  for (std::size_t size = 0; size <= 80; ++size) {
    const Bytes bytes(size, 0x5a);
    EXPECT_EQ(parse_device_report(bytes, ReportForm::Mbed).has_value(), size == 14) << size;
    EXPECT_EQ(parse_device_report(bytes, ReportForm::Teensy).has_value(), size == 64) << size;
  }
}

TEST(PhantomCodec, KnowsTheFormByTheLengthsOfBothDirections) {
  EXPECT_EQ(form_of(14, 14), ReportForm::Mbed);
  EXPECT_EQ(form_of(64, 64), ReportForm::Teensy);
  EXPECT_EQ(form_of(14, 64), std::nullopt);
  EXPECT_EQ(form_of(65, 65), std::nullopt);
  EXPECT_EQ(form_of(0, 0), std::nullopt);
}

TEST(PhantomCodec, EncodesCurrentsInMilliampere) {
  // 1 A = 1000 = 0x03e8; -0.0006 A rounds to -1; 2.5004 A rounds to 2500 = 0x09c4.
  const Bytes expected = {0xe8, 0x03, 0xff, 0xff, 0xc4, 0x09, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(bytes_of(encode_currents({1.0, -0.0006, 2.5004}, ReportForm::Mbed)), expected);
  EXPECT_EQ(bytes_of(encode_currents({1.0, -0.0006, 2.5004}, ReportForm::Teensy)),
            padded(expected));
}

TEST(PhantomCodec, ClampsCurrentsToTheRangeOfTheField) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bytes_of(encode_currents({40, -40, 1e300}, ReportForm::Mbed)),
            (Bytes{0xff, 0x7f, 0x01, 0x80, 0xff, 0x7f, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bytes_of(encode_currents({infinity, -infinity, nan}, ReportForm::Mbed)), Bytes(14, 0));
}

TEST(PhantomCodec, ZeroesCountersWithoutAnyCurrent) {
  EXPECT_EQ(bytes_of(encode_zero_counters(ReportForm::Mbed)),
            (Bytes{0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bytes_of(encode_zero_counters(ReportForm::Teensy)),
            padded({0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}));
}

// The other direction, written apart from the codec's own arithmetic.
TEST(PhantomCodec, ParsesWhatAPlainEncoderWrites) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> any_count(-32768, 32767);
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes;
    std::array<int, 7> field{};
    for (int& value : field) {
      value = any_count(random);
      const int positive = value < 0 ? value + 65536 : value;
      bytes.push_back(static_cast<std::uint8_t>(positive % 256));
      bytes.push_back(static_cast<std::uint8_t>(positive / 256));
    }
    const auto report = parse_device_report(bytes, ReportForm::Mbed);
    ASSERT_TRUE(report);
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_EQ(report->base_counts[i], field[i]);
      ASSERT_EQ(report->gimbal_counts[i], field[i + 3]);
    }
    ASSERT_EQ(report->is_calibration_pressed, (field[6] & 1) != 0);
  }
}

}  // namespace
}  // namespace thimble::phantom
