#include "tests/contract/hid_device_contract.hpp"

#include <algorithm>
#include <random>

#include "tests/contract/byte_pattern.hpp"

namespace thimble::test {
namespace {

std::vector<std::uint8_t> bytes_of(const bus::HidReport& report) {
  return {report.payload().begin(), report.payload().end()};
}

}  // namespace

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(HidDeviceContract);

std::vector<std::uint8_t> HidDeviceContract::input(std::uint8_t seed) const {
  return pattern(rig->input_report_bytes(), seed);
}
std::vector<std::uint8_t> HidDeviceContract::output(std::uint8_t seed) const {
  return pattern(rig->output_report_bytes(), seed);
}

TEST_P(HidDeviceContract, NothingArrivedLeavesTheOutputUntouched) {
  run_frames(3);
  bus::HidReport report;
  report.sequence = 77;
  report.size = 3;

  EXPECT_EQ(rig->device().read_newest(report), IoStatus::NoData);

  EXPECT_EQ(report.sequence, 77U);
  EXPECT_EQ(report.size, 3U);
  EXPECT_EQ(rig->device().counters().reports_in, 0U);
}

TEST_P(HidDeviceContract, AReportArrivesOnceWithItsBytes) {
  rig->device_sends(input(1));
  run_frames(2);
  bus::HidReport report;

  ASSERT_EQ(rig->device().read_newest(report), IoStatus::Ok);

  EXPECT_EQ(bytes_of(report), input(1));
  EXPECT_EQ(rig->device().read_newest(report), IoStatus::NoData);
}

TEST_P(HidDeviceContract, TheNewestReportWinsAndTheOthersAreCounted) {
  for (std::uint8_t i = 1; i <= 5; ++i) rig->device_sends(input(i));
  run_frames(7);
  bus::HidReport report;

  ASSERT_EQ(rig->device().read_newest(report), IoStatus::Ok);

  EXPECT_EQ(bytes_of(report), input(5));
  EXPECT_EQ(report.sequence, 5U);
  EXPECT_EQ(rig->device().counters().reports_in, 5U);
  EXPECT_EQ(rig->device().counters().reports_skipped, 4U);
}

TEST_P(HidDeviceContract, AReportOfAnyLengthUpToAPacketKeepsItOrIsLostWhereItIsTooShort) {
  for (std::size_t size = 1; size <= bus::kMaxHidReportBytes; ++size) {
    rig->device_sends(pattern(size, 9));
    run_frames(2);
    bus::HidReport report;
    const IoStatus status = rig->device().read_newest(report);
    if (status == IoStatus::NoData && size < rig->least_report_bytes()) continue;
    ASSERT_EQ(status, IoStatus::Ok) << size;
    ASSERT_EQ(bytes_of(report), pattern(size, 9)) << size;
  }
}

TEST_P(HidDeviceContract, AnOutputReportReachesTheDevice) {
  EXPECT_EQ(rig->device().submit(output(3)), IoStatus::Ok);
  run_frames(2);

  ASSERT_EQ(rig->received_by_device().size(), 1U);
  EXPECT_EQ(rig->received_by_device()[0], output(3));
  EXPECT_EQ(rig->device().counters().reports_out, 1U);
}

TEST_P(HidDeviceContract, TheLatestOfSeveralSubmitsWinsAndEachIsCounted) {
  for (std::uint8_t i = 1; i <= 4; ++i) {
    const IoStatus status = rig->device().submit(output(i));
    EXPECT_TRUE(status == IoStatus::Ok || status == IoStatus::Backlogged) << to_string(status);
  }
  run_frames(5);

  ASSERT_FALSE(rig->received_by_device().empty());
  EXPECT_EQ(rig->received_by_device().back(), output(4));
  const bus::HidCounters counters = rig->device().counters();
  EXPECT_EQ(counters.reports_out, rig->received_by_device().size());
  EXPECT_EQ(counters.reports_out + counters.writes_superseded, 4U);
}

TEST_P(HidDeviceContract, AReportIsSentOnceOnly) {
  rig->device().submit(output(1));
  run_frames(10);
  EXPECT_EQ(rig->received_by_device().size(), 1U);
}

TEST_P(HidDeviceContract, AReportOfAnotherSizeIsRefusedAndNotSent) {
  for (const std::size_t size : {std::size_t{0}, rig->output_report_bytes() - 1,
                                 rig->output_report_bytes() + 1, bus::kMaxHidReportBytes + 1}) {
    EXPECT_EQ(rig->device().submit(pattern(size, 1)), IoStatus::ProtocolError) << size;
  }
  run_frames(3);
  EXPECT_TRUE(rig->received_by_device().empty());
  EXPECT_EQ(rig->device().counters().reports_out, 0U);
  EXPECT_EQ(rig->device().counters().writes_superseded, 0U);
}

TEST_P(HidDeviceContract, AfterUnplugEveryCallSaysDisconnected) {
  rig->device_sends(input(1));
  run_frames(2);
  rig->unplug();
  run_frames(2);
  bus::HidReport report;
  report.sequence = 77;

  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(rig->device().read_newest(report), IoStatus::Disconnected);
    EXPECT_EQ(rig->device().submit(output(1)), IoStatus::Disconnected);
    run_frames(1);
  }
  EXPECT_EQ(report.sequence, 77U);
  EXPECT_TRUE(rig->received_by_device().empty());
}

TEST_P(HidDeviceContract, ClosingEndsSilent) {
  rig->device().submit(output(1));
  run_frames(2);
  rig->close_device();
  run_frames(5);
  EXPECT_EQ(rig->received_by_device().size(), 1U);
}

// A kernel may still send it, a simulated bus drops it: but nothing else comes, and nothing twice.
TEST_P(HidDeviceContract, WhatIsSubmittedRightBeforeClosingIsSentOnceOrDropped) {
  rig->device().submit(output(1));
  run_frames(2);
  rig->device().submit(output(2));
  rig->close_device();
  run_frames(10);
  const auto received = rig->received_by_device();
  ASSERT_GE(received.size(), 1U);
  ASSERT_LE(received.size(), 2U);
  for (std::size_t i = 0; i < received.size(); ++i) {
    EXPECT_EQ(received[i], output(static_cast<std::uint8_t>(i + 1)));
  }
}

// Random traffic: the stamps never run backwards, and every report is read or skipped.
TEST_P(HidDeviceContract, TheCountersBalanceUnderRandomTraffic) {
  std::mt19937 random(5);
  std::uint64_t sent = 0;
  std::uint64_t read = 0;
  std::uint64_t submitted = 0;
  bus::HidReport report;
  for (int step = 0; step < 400; ++step) {
    const MonotonicTime last_arrival = report.arrived_at;
    const std::uint64_t last_sequence = report.sequence;
    switch (random() % 4) {
      case 0:
        rig->device_sends(input(static_cast<std::uint8_t>(++sent)));
        break;
      case 1:
        rig->device().submit(output(static_cast<std::uint8_t>(++submitted)));
        break;
      case 2:
        run_frames(static_cast<int>(random() % 3));
        break;
      default:
        if (rig->device().read_newest(report) != IoStatus::Ok) break;
        ++read;
        ASSERT_GE(report.arrived_at, last_arrival);
        ASSERT_GT(report.sequence, last_sequence);
        ASSERT_EQ(bytes_of(report), input(static_cast<std::uint8_t>(report.sequence)));
    }
  }
  run_frames(static_cast<int>(sent) + 2);
  if (rig->device().read_newest(report) == IoStatus::Ok) ++read;

  const bus::HidCounters counters = rig->device().counters();
  EXPECT_EQ(counters.reports_in, sent);
  EXPECT_EQ(counters.reports_skipped + read, sent);
  EXPECT_EQ(counters.reports_out + counters.writes_superseded, submitted);
  EXPECT_EQ(counters.reports_out, rig->received_by_device().size());
}

}  // namespace thimble::test
