#include "hal/bus/hid_report_descriptor.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace thimble::bus {
namespace {

using std::string_literals::operator""s;

const std::string kBytes = "\x75\x08"s;  // fields of 8 bits

TEST(HidReportDescriptor, TellsTheLengthOfReportsEachWay) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x95\x0d\x81\x02\x95\x08\x91\x02"),
            (HidReportLengths{13, 8}));
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x96\x40\x00\x81\x02\x97\x02\x00\x00\x00\x91\x02"s),
            (HidReportLengths{64, 2}));
  EXPECT_EQ(parse_report_descriptor(""), HidReportLengths{});
}

TEST(HidReportDescriptor, AddsFieldsUpAndRoundsToBytes) {
  EXPECT_EQ(parse_report_descriptor("\x75\x01\x95\x03\x81\x02\x75\x0a\x95\x01\x81\x02"),
            (HidReportLengths{2, 0}));
}

TEST(HidReportDescriptor, TakesTheLongestOfNumberedReports) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x85\x01\x95\x04\x81\x02\x85\x02\x95\x09\x81\x02"),
            (HidReportLengths{10, 0, true}))
      << "the number is the first byte";
}

TEST(HidReportDescriptor, PutsBackWhatWasPushed) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x95\x04\xa4\x95\x09\xb4\x81\x02"),
            (HidReportLengths{4, 0}));
}

TEST(HidReportDescriptor, SkipsLongItems) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\xfe\x02\x10\x81\x02\x95\x03\x81\x02"),
            (HidReportLengths{3, 0}));
}

TEST(HidReportDescriptor, OfPlainReportsSaysTheirLengthsWhateverTheyAre) {
  for (const std::size_t in : {0U, 1U, 14U, 64U, 255U, 256U, 8192U}) {
    for (const std::size_t out : {0U, 1U, 14U, 64U, 255U, 256U, 8192U}) {
      const std::vector<std::uint8_t> bytes = plain_report_descriptor({in, out});
      EXPECT_EQ(parse_report_descriptor(std::string(bytes.begin(), bytes.end())),
                (HidReportLengths{in, out}));
    }
  }
}

TEST(HidReportDescriptor, OfPlainNumberedReportsSaysTheLongestEachWay) {
  const std::vector<HidNumberedReport> reports{{1, false, 12}, {3, false, 4}, {4, true, 1}};
  const std::vector<std::uint8_t> bytes = plain_report_descriptor(reports);
  EXPECT_EQ(parse_report_descriptor(std::string(bytes.begin(), bytes.end())),
            (HidReportLengths{13, 2, true}));
}

TEST(HidReportDescriptor, IsNothingWhenItCannotBe) {
  for (const std::string& odd :
       {"\x75"s, "\x97\x01\x02\x03"s, "\xfe\x02"s, "\xfe\x02\x10\x01"s, "\xb4"s, "\x85\x00"s,
        "\x86\x00\x01"s, kBytes + "\x97\xff\xff\xff\xff\x81\x02", std::string(17, '\xa4')}) {
    EXPECT_FALSE(parse_report_descriptor(odd)) << odd.size();
  }
}

TEST(HidReportDescriptor, IsTakenWhateverItsBytesAre) {
  constexpr std::size_t kLongest = 8193;
  std::mt19937 random(6);
  for (int i = 0; i < 20000; ++i) {
    std::string bytes(random() % 40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const auto reports = parse_report_descriptor(bytes);
    if (!reports) continue;
    EXPECT_LE(reports->input_bytes, kLongest);
    EXPECT_LE(reports->output_bytes, kLongest);
  }
}

}  // namespace
}  // namespace thimble::bus
