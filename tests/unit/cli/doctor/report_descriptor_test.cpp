#include "cli/doctor/report_descriptor.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace thimble::doctor {
namespace {

using std::string_literals::operator""s;

const std::string kBytes = "\x75\x08"s;  // fields of 8 bits

TEST(ReportDescriptor, TellsTheLengthOfReportsEachWay) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x95\x0d\x81\x02\x95\x08\x91\x02"),
            (ReportBytes{13, 8}));
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x96\x40\x00\x81\x02\x97\x02\x00\x00\x00\x91\x02"s),
            (ReportBytes{64, 2}));
  EXPECT_EQ(parse_report_descriptor(""), ReportBytes{});
}

TEST(ReportDescriptor, AddsFieldsUpAndRoundsToBytes) {
  EXPECT_EQ(parse_report_descriptor("\x75\x01\x95\x03\x81\x02\x75\x0a\x95\x01\x81\x02"),
            (ReportBytes{2, 0}));
}

TEST(ReportDescriptor, TakesTheLongestOfNumberedReports) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x85\x01\x95\x04\x81\x02\x85\x02\x95\x09\x81\x02"),
            (ReportBytes{9, 0}));
}

TEST(ReportDescriptor, PutsBackWhatWasPushed) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\x95\x04\xa4\x95\x09\xb4\x81\x02"),
            (ReportBytes{4, 0}));
}

TEST(ReportDescriptor, SkipsLongItems) {
  EXPECT_EQ(parse_report_descriptor(kBytes + "\xfe\x02\x10\x81\x02\x95\x03\x81\x02"),
            (ReportBytes{3, 0}));
}

TEST(ReportDescriptor, IsNothingWhenItCannotBe) {
  for (const std::string& odd :
       {"\x75"s, "\x97\x01\x02\x03"s, "\xfe\x02"s, "\xfe\x02\x10\x01"s, "\xb4"s, "\x85\x00"s,
        "\x86\x00\x01"s, kBytes + "\x97\xff\xff\xff\xff\x81\x02", std::string(17, '\xa4')}) {
    EXPECT_FALSE(parse_report_descriptor(odd)) << odd.size();
  }
}

TEST(ReportDescriptor, IsTakenWhateverItsBytesAre) {
  constexpr std::size_t kLongest = 8192;
  std::mt19937 random(6);
  for (int i = 0; i < 20000; ++i) {
    std::string bytes(random() % 40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const auto reports = parse_report_descriptor(bytes);
    if (!reports) continue;
    EXPECT_LE(reports->input, kLongest);
    EXPECT_LE(reports->output, kLongest);
  }
}

}  // namespace
}  // namespace thimble::doctor
