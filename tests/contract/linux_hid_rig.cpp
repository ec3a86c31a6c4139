// What the real bus does with hidapi, under the HID contract suite. In place of hidapi and the
// kernel stands tests/support/fake_hidapi.cpp, in place of the threads the test, so that every run
// is the same. Over a real kernel it is for the VM tier to run.
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "hal/linux/hid_transfers.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/hid_device_contract.hpp"
#include "tests/support/fake_hid_kernel.hpp"
#include "tests/support/fake_hidapi.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;
using Report = FakeHidWire::Report;

constexpr std::size_t kInputBytes = 14;
constexpr std::size_t kOutputBytes = 8;

class LinuxHidRig final : public HidRig {
 public:
  enum class WayOut : std::uint8_t { Hidraw, Hiddev };

  explicit LinuxHidRig(WayOut way) : way_(way) {
    kernel_.fields = {{kOutputBytes}};
    auto opened = linux::HidTransfers::open(wire_.node(), false, mail_, clock_, hidapi_, hiddev());
    EXPECT_TRUE(opened.has_value());
    transfers_ = std::move(opened.value());
  }
  ~LinuxHidRig() override {
    transfers_.reset();
    EXPECT_EQ(wire_.breaches(), std::vector<std::string>{});
    EXPECT_EQ(FakeHidWire::alive(), 0) << "every handle must be closed";
  }
  bus::HidDevice& device() override { return mail_; }
  void close_device() override { transfers_.reset(); }
  void device_sends(std::span<const std::uint8_t> report) override {
    to_send_.emplace_back(report.begin(), report.end());
  }
  std::vector<Report> received_by_device() override {
    std::vector<Report> all = wire_.received_by_device();
    EXPECT_TRUE(way_ == WayOut::Hidraw || all.empty()) << "it left by hidraw";
    for (const FakeHidKernel::Report& report : kernel_.sent) all.push_back(report.bytes);
    return all;
  }
  void unplug() override {
    wire_.unplug();
    kernel_.is_unplugged = true;
  }
  void run_for(Duration duration) override {
    for (Duration run{}; run < duration; run += frame_period()) {
      if (!to_send_.empty()) {
        wire_.device_sends(to_send_.front());
        to_send_.pop_front();
      }
      if (transfers_ != nullptr) {
        while (transfers_->receive(0)) {
        }
        transfers_->send();
      }
      clock_.run_for(frame_period());
    }
  }
  std::size_t input_report_bytes() const override { return kInputBytes; }
  std::size_t output_report_bytes() const override { return kOutputBytes; }
  Duration frame_period() const override { return milliseconds(1); }

 private:
  std::optional<linux::HiddevOutput> hiddev() {
    if (way_ == WayOut::Hidraw) return std::nullopt;
    return linux::HiddevOutput(kNode, kernel_);
  }

  static constexpr int kNode = 7;
  WayOut way_;
  FakeHidKernel kernel_;
  sim::VirtualClock clock_;
  std::mutex hidapi_;
  FakeHidWire wire_;
  bus::HidMailboxes mail_{kOutputBytes};
  std::unique_ptr<linux::HidTransfers> transfers_;
  std::deque<Report> to_send_;
};

template <LinuxHidRig::WayOut way>
std::unique_ptr<HidRig> make() {
  return std::make_unique<LinuxHidRig>(way);
}

INSTANTIATE_TEST_SUITE_P(
    Linux, HidDeviceContract,
    testing::Values(HidRigFactory{"HidTransfers", &make<LinuxHidRig::WayOut::Hidraw>},
                    HidRigFactory{"HidTransfersOverHiddev", &make<LinuxHidRig::WayOut::Hiddev>}),
    rig_name);

struct HidTransfersTest : testing::Test {
  sim::VirtualClock clock;
  std::mutex hidapi;
  FakeHidWire wire;
  bus::HidMailboxes mail{kOutputBytes};
  const Report out = Report(kOutputBytes, 7);

  std::unique_ptr<linux::HidTransfers> open(bool has_report_ids = false) {
    return linux::HidTransfers::open(wire.node(), has_report_ids, mail, clock, hidapi, std::nullopt)
        .value();
  }
  ~HidTransfersTest() override {
    EXPECT_EQ(wire.breaches(), std::vector<std::string>{});
    EXPECT_EQ(FakeHidWire::alive(), 0);
  }
};

TEST_F(HidTransfersTest, AReportThatIsTooLongIsLostAndTheNextArrives) {
  const auto sut = open();
  wire.device_sends(Report(bus::kMaxHidReportBytes + 1, 1));
  wire.device_sends(Report(4000, 2));
  wire.device_sends(Report(bus::kMaxHidReportBytes, 3));
  while (sut->receive(0)) {
  }
  bus::HidReport report;
  ASSERT_EQ(mail.read_newest(report), IoStatus::Ok);
  EXPECT_EQ(report.size, bus::kMaxHidReportBytes);
  EXPECT_EQ(report.bytes[0], 3);
  EXPECT_EQ(mail.counters().reports_in, 1U);
}

TEST_F(HidTransfersTest, AWriteThatFailsOrIsCutIsCountedAndNotRepeated) {
  const auto sut = open();
  wire.fail_next_writes(2);
  wire.cut_next_writes(1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(mail.submit(out), i == 0 ? IoStatus::Ok : IoStatus::Backlogged) << i;
    sut->send();
    sut->send();
  }
  EXPECT_EQ(mail.counters().writes_failed, 3U);
  EXPECT_TRUE(wire.received_by_device().empty());
  EXPECT_EQ(mail.submit(out), IoStatus::Backlogged) << "none has reached the device";
  sut->send();
  EXPECT_EQ(wire.received_by_device(), std::vector<Report>{out});
  EXPECT_EQ(mail.counters().reports_out, 1U);
  EXPECT_EQ(mail.submit(out), IoStatus::Ok) << "the device is not given up for it";
}

// Here, not in the suite: no write to a simulated HID device can fail.
TEST_F(HidTransfersTest, AWayOutThatFailsEveryTimeNeverLooksFree) {
  const auto sut = open();
  wire.fail_next_writes(1000);
  for (int i = 0; i < 100; ++i) {
    wire.device_sends({1, 2});
    EXPECT_TRUE(sut->receive(0)) << "input flows meanwhile";
    EXPECT_EQ(mail.submit(out), i == 0 ? IoStatus::Ok : IoStatus::Backlogged) << i;
    sut->send();
  }
  EXPECT_EQ(mail.counters().writes_failed, 100U);
}

TEST_F(HidTransfersTest, ADeviceWithNumberedReportsGetsAndGivesTheNumberFirst) {
  const auto sut = open(true);
  wire.device_sends({3, 1, 2});
  while (sut->receive(0)) {
  }
  bus::HidReport report;
  ASSERT_EQ(mail.read_newest(report), IoStatus::Ok);
  EXPECT_EQ(Report(report.payload().begin(), report.payload().end()), (Report{3, 1, 2}));
  ASSERT_EQ(mail.submit(out), IoStatus::Ok);
  sut->send();
  EXPECT_EQ(wire.received_by_device(), std::vector<Report>{out}) << "nothing is put before it";
}

TEST_F(HidTransfersTest, NothingIsWrittenAfterAnUnplugWasSeen) {
  const auto sut = open();
  EXPECT_EQ(mail.submit(out), IoStatus::Ok);
  wire.unplug();
  EXPECT_FALSE(sut->receive(0));
  sut->send();
  EXPECT_EQ(mail.counters().writes_failed, 0U);
  EXPECT_EQ(mail.submit(out), IoStatus::Disconnected);
}

TEST_F(HidTransfersTest, AWriteIntoAnUnplugFailsAndReadingSaysThatItIsGone) {
  const auto sut = open();
  EXPECT_EQ(mail.submit(out), IoStatus::Ok);
  wire.unplug();
  sut->send();
  EXPECT_EQ(mail.counters().writes_failed, 1U);
  EXPECT_FALSE(mail.is_disconnected());
  EXPECT_FALSE(sut->receive(0));
  EXPECT_TRUE(mail.is_disconnected());
}

TEST_F(HidTransfersTest, TheNodeIsLockedUntilItIsClosed) {
  auto sut = open();
  const auto second =
      linux::HidTransfers::open(wire.node(), false, mail, clock, hidapi, std::nullopt);
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, Errc::Busy);
  EXPECT_NE(second.error().message.find(wire.node()), std::string::npos);
  sut.reset();
  EXPECT_TRUE(
      linux::HidTransfers::open(wire.node(), false, mail, clock, hidapi, std::nullopt).has_value());
}

TEST_F(HidTransfersTest, ARefusalLeaksNothing) {
  const auto nowhere =
      linux::HidTransfers::open(wire.node() + "0", false, mail, clock, hidapi, std::nullopt);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().code, Errc::NotFound);
  wire.refuse_next_opening(1);
  const auto refused =
      linux::HidTransfers::open(wire.node(), false, mail, clock, hidapi, std::nullopt);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, Errc::System);
  EXPECT_EQ(FakeHidWire::alive(), 0);
  EXPECT_NE(open(), nullptr) << "the lock is gone, too";
}

}  // namespace
}  // namespace thimble::test
