#include "sim/export/uhid_plug.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "sim/model/arm/arm_parameters.hpp"
#include "sim/model/arm/phantom_arm_model.hpp"
#include "tests/support/scripted_hid_model.hpp"
#include "tests/unit/export/export_bench.hpp"
#include "tests/unit/export/fake_uhid.hpp"

namespace thimble::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;
using plugin::HidReportKind;

// A device with numbered feature reports, which keeps what it is told.
class FeatureModel final : public plugin::SimHidModel {
 public:
  explicit FeatureModel(bool has_numbers) : has_numbers_(has_numbers) {}
  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    bus::BusDeviceInfo info;
    info.has_report_ids = has_numbers_;
    info.output_report_bytes = 8;
    return info;
  }
  [[nodiscard]] Duration frame_period() const noexcept override {
    return std::chrono::milliseconds(1);
  }
  [[nodiscard]] std::vector<std::uint8_t> report_descriptor() const override { return {0xC0}; }
  void advance(MonotonicTime) noexcept override {}
  void out_report(std::span<const std::uint8_t>) noexcept override {}
  std::size_t in_report(std::span<std::uint8_t>) noexcept override { return 0; }
  std::size_t get_report(HidReportKind kind, std::uint8_t number,
                         std::span<std::uint8_t> out) noexcept override {
    if (kind != HidReportKind::Feature || number > 9) return 0;
    out[0] = number;
    out[1] = 0xAB;
    return 2;
  }
  bool set_report(HidReportKind, std::span<const std::uint8_t> bytes) noexcept override {
    set_.assign(bytes.begin(), bytes.end());
    return !set_.empty() && set_[0] < 10;
  }
  void power_cycle() noexcept override {}
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

  Bytes set_;

 private:
  bool has_numbers_;
};

class UhidPlugTest : public ::testing::Test {
 protected:
  UhidPlugTest()
      : model_(script_),
        sut_(kernel_.take_device_end(), model_, named(model_), bench_.surroundings()) {}

  static bus::BusDeviceInfo named(const plugin::SimHidModel& model) {
    bus::BusDeviceInfo info = model.describe();
    info.serial_number = "SN7";
    return info;
  }
  void plug_and_open() {
    ASSERT_TRUE(sut_.plug());
    kernel_.say(UHID_START);
    kernel_.say(UHID_OPEN);
    bench_.run_frames(1);
    while (kernel_.heard()) {
    }
  }
  static Bytes report(std::uint8_t first) {
    Bytes bytes(test::ScriptedHidModel::kInputBytes);
    bytes[0] = first;
    return bytes;
  }

  ExportBench bench_;
  FakeUhid kernel_;
  std::shared_ptr<test::HidModelScript> script_ = std::make_shared<test::HidModelScript>();
  test::ScriptedHidModel model_;
  UhidPlug sut_;
};

TEST_F(UhidPlugTest, MakesTheDeviceWhenPluggedInAndNotBefore) {
  bench_.run_frames(3);
  EXPECT_FALSE(kernel_.heard());
  EXPECT_FALSE(sut_.is_plugged());
  ASSERT_TRUE(sut_.plug());
  const auto event = kernel_.heard();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->type, std::uint32_t{UHID_CREATE2});
  EXPECT_EQ(event->u.create2.vendor, 0x1234U);
  EXPECT_STREQ(reinterpret_cast<const char*>(event->u.create2.uniq), "SN7");
  EXPECT_EQ(event->u.create2.rd_size, model_.report_descriptor().size());
  EXPECT_EQ(sut_.plug().error().code, Errc::Busy);
}

TEST_F(UhidPlugTest, UnpluggedTheKernelLosesTheDeviceAndTheDeviceItsPower) {
  EXPECT_EQ(sut_.unplug(Supply::Goes).error().code, Errc::NotFound);
  plug_and_open();
  const int before = script_->power_cycles;
  ASSERT_TRUE(sut_.unplug(Supply::Goes));
  EXPECT_EQ(kernel_.heard()->type, std::uint32_t{UHID_DESTROY});
  EXPECT_EQ(script_->power_cycles, before + 1);
  EXPECT_FALSE(sut_.is_open());
  script_->to_send.push_back(report(1));
  bench_.run_frames(3);
  EXPECT_FALSE(kernel_.heard());
  EXPECT_TRUE(sut_.plug());
}

TEST_F(UhidPlugTest, SendsOneReportAFrameWhileSomebodyHasItOpen) {
  plug_and_open();
  script_->to_send = {report(1), {}, report(2)};
  bench_.run_frames(1);
  EXPECT_EQ(kernel_.last_input()->data[0], 1);
  bench_.run_frames(1);
  EXPECT_FALSE(kernel_.last_input());
  bench_.run_frames(1);
  const auto last = kernel_.last_input();
  EXPECT_EQ(last->data[0], 2);
  EXPECT_EQ(last->size, test::ScriptedHidModel::kInputBytes);
  EXPECT_EQ(sut_.counters().to_host, 2U);
}

TEST_F(UhidPlugTest, KeepsOneReportInTheEndpointUntilSomebodyOpensIt) {
  ASSERT_TRUE(sut_.plug());
  script_->to_send = {report(1), report(2)};
  bench_.run_frames(5);
  EXPECT_FALSE(kernel_.last_input());
  EXPECT_EQ(script_->to_send.size(), 1U);
  kernel_.say(UHID_OPEN);
  bench_.run_frames(1);
  EXPECT_EQ(kernel_.last_input()->data[0], 1);
  kernel_.say(UHID_CLOSE);
  bench_.run_frames(5);
  EXPECT_FALSE(kernel_.last_input());
}

TEST_F(UhidPlugTest, GivesTheModelWhatWasWrittenWithoutTheKernelsZero) {
  plug_and_open();
  kernel_.write_output({0, 1, 2, 3, 4, 5, 6, 7, 8});
  bench_.run_frames(1);
  EXPECT_EQ(script_->received, (std::vector<Bytes>{{1, 2, 3, 4, 5, 6, 7, 8}}));
  kernel_.write_output({0, 2, 3, 4, 5, 6, 7, 8});  // whole without one
  bench_.run_frames(1);
  EXPECT_EQ(script_->received.back(), (Bytes{0, 2, 3, 4, 5, 6, 7, 8}));
}

TEST_F(UhidPlugTest, OfSeveralWritesInAFrameTheNewestCounts) {
  plug_and_open();
  for (std::uint8_t value = 1; value <= 3; ++value)
    kernel_.write_output({0, value, 0, 0, 0, 0, 0, 0, 0});
  bench_.run_frames(2);
  ASSERT_EQ(script_->received.size(), 1U);
  EXPECT_EQ(script_->received[0][0], 3);
  EXPECT_EQ(sut_.counters().superseded, 2U);
  EXPECT_EQ(sut_.counters().from_host, 1U);
}

TEST_F(UhidPlugTest, SilentItNeitherTakesNorGivesAndGoesOnWhereItWas) {
  plug_and_open();
  bench_.misbehaviour.be_silent_until(bench_.clock.now() + std::chrono::milliseconds(3));
  script_->to_send = {report(1)};
  kernel_.write_output({0, 9, 0, 0, 0, 0, 0, 0, 0});
  bench_.run_frames(2);
  EXPECT_FALSE(kernel_.last_input());
  EXPECT_TRUE(script_->received.empty());
  EXPECT_EQ(bench_.misbehaviour.struck().unanswered, 2U);
  bench_.run_frames(1);
  EXPECT_TRUE(kernel_.last_input());
  EXPECT_EQ(script_->received.size(), 1U);
}

TEST_F(UhidPlugTest, StalledItLosesWhatIsWritten) {
  plug_and_open();
  bench_.misbehaviour.stall_until(bench_.clock.now() + std::chrono::milliseconds(3));
  kernel_.write_output({0, 9, 0, 0, 0, 0, 0, 0, 0});
  bench_.run_frames(5);
  EXPECT_TRUE(script_->received.empty());
  EXPECT_EQ(sut_.counters().lost, 1U);
  EXPECT_EQ(bench_.misbehaviour.struck().refused, 1U);
}

TEST_F(UhidPlugTest, ShortAndBabblingReportsGoOutAsTheyAre) {
  plug_and_open();
  bench_.misbehaviour.shorten(1);
  script_->to_send = {report(1), report(2)};
  bench_.run_frames(1);
  EXPECT_EQ(kernel_.last_input()->size, test::ScriptedHidModel::kInputBytes / 2);
  bench_.misbehaviour.babble(1);
  bench_.run_frames(1);
  EXPECT_GT(kernel_.last_input()->size, test::ScriptedHidModel::kInputBytes);
}

TEST_F(UhidPlugTest, WritesDownWhatWentBothWays) {
  plug_and_open();
  script_->to_send = {report(0x5A)};
  kernel_.write_output({0, 0xF1, 0, 0, 0, 0, 0, 0, 0});
  bench_.run_frames(1);
  const std::string lines = bench_.lines();
  EXPECT_NE(lines.find(R"("out":"f100000000000000")"), std::string::npos) << lines;
  EXPECT_NE(lines.find(R"("in":"5a)"), std::string::npos) << lines;
}

TEST_F(UhidPlugTest, CountsBytesThatAreNoEventAndGoesOn) {
  plug_and_open();
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    Bytes bytes(1 + random() % 4380);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    kernel_.say_bytes(bytes.data(), bytes.size());
    bench_.run_frames(1);
  }
  EXPECT_GT(sut_.counters().malformed, 190U);
  EXPECT_FALSE(sut_.is_broken());
  script_->to_send = {report(1)};
  bench_.run_frames(1);
  EXPECT_TRUE(kernel_.last_input());
}

TEST_F(UhidPlugTest, ItsCableAlonePulledTheDeviceKeepsItsPowerAndNothingThatTheHostWrote) {
  plug_and_open();
  const int before = script_->power_cycles;
  kernel_.write_output({0, 5});
  ASSERT_TRUE(sut_.unplug(Supply::Stays));
  bench_.run_frames(3);
  ASSERT_TRUE(sut_.plug());
  bench_.run_frames(3);
  EXPECT_EQ(script_->power_cycles, before);
  EXPECT_TRUE(script_->received.empty());
}

TEST_F(UhidPlugTest, AfterItsCableItsSupplyMayGoToo) {
  plug_and_open();
  const int before = script_->power_cycles;
  ASSERT_TRUE(sut_.unplug(Supply::Stays));
  EXPECT_EQ(kernel_.heard()->type, std::uint32_t{UHID_DESTROY});
  EXPECT_FALSE(sut_.unplug(Supply::Stays));
  ASSERT_TRUE(sut_.unplug(Supply::Goes));
  EXPECT_FALSE(sut_.unplug(Supply::Goes));
  EXPECT_FALSE(kernel_.heard()) << "it has lost the device already";
  EXPECT_EQ(script_->power_cycles, before + 1);
  ASSERT_TRUE(sut_.plug());
  EXPECT_EQ(script_->power_cycles, before + 2);
}

TEST_F(UhidPlugTest, IsBrokenWhenTheKernelIsGone) {
  plug_and_open();
  kernel_.close();
  bench_.run_frames(1);
  EXPECT_TRUE(sut_.is_broken());
  EXPECT_EQ(sut_.unplug(Supply::Goes).error().code, Errc::System);
}

class UhidRequestTest : public ::testing::TestWithParam<bool> {
 protected:
  UhidRequestTest()
      : model_(GetParam()),
        sut_(kernel_.take_device_end(), model_, model_.describe(), bench_.surroundings()) {
    EXPECT_TRUE(sut_.plug());
    kernel_.heard();
  }
  uhid_event ask(const uhid_event& event) {
    kernel_.say(event);
    bench_.run_frames(1);
    const auto answer = kernel_.heard();
    EXPECT_TRUE(answer);
    EXPECT_FALSE(kernel_.heard()) << "one answer each";
    return answer.value_or(uhid_event{});
  }
  uhid_get_report_reply_req get(std::uint8_t number) {
    uhid_event event{};
    event.type = UHID_GET_REPORT;
    event.u.get_report = {.id = 40, .rnum = number, .rtype = UHID_FEATURE_REPORT};
    const uhid_event answer = ask(event);
    EXPECT_EQ(answer.type, std::uint32_t{UHID_GET_REPORT_REPLY});
    EXPECT_EQ(answer.u.get_report_reply.id, 40U);
    return answer.u.get_report_reply;
  }
  std::uint16_t set(const Bytes& bytes) {
    uhid_event event{};
    event.type = UHID_SET_REPORT;
    event.u.set_report = {.id = 41,
                          .rnum = bytes[0],
                          .rtype = UHID_FEATURE_REPORT,
                          .size = static_cast<std::uint16_t>(bytes.size()),
                          .data = {}};
    std::copy(bytes.begin(), bytes.end(), event.u.set_report.data);
    const uhid_event answer = ask(event);
    EXPECT_EQ(answer.type, std::uint32_t{UHID_SET_REPORT_REPLY});
    EXPECT_EQ(answer.u.set_report_reply.id, 41U);
    return answer.u.set_report_reply.err;
  }

  ExportBench bench_;
  FakeUhid kernel_;
  FeatureModel model_;
  UhidPlug sut_;
};

TEST_P(UhidRequestTest, AnswersWithWhatTheModelSays) {
  const bool has_numbers = GetParam();
  const auto reply = get(3);
  EXPECT_EQ(reply.err, 0);
  EXPECT_EQ(reply.size, has_numbers ? 2 : 3);
  EXPECT_EQ(reply.data[has_numbers ? 1 : 2], 0xAB);
}

TEST_P(UhidRequestTest, SaysWhatTheModelRefuses) {
  EXPECT_EQ(get(10).err, EPIPE);
  EXPECT_EQ(set({10, 1}), EPIPE);
}

TEST_P(UhidRequestTest, TellsTheModelWhatItIsToSet) {
  EXPECT_EQ(set({4, 1, 2}), 0);
  EXPECT_EQ(model_.set_, (Bytes{4, 1, 2}));
  EXPECT_NE(bench_.lines().find(R"("request":"040102")"), std::string::npos);
}

TEST_P(UhidRequestTest, AStalledDeviceRefusesAll) {
  bench_.misbehaviour.stall_until(bench_.clock.now() + std::chrono::seconds(1));
  EXPECT_EQ(get(3).err, EPIPE);
  EXPECT_EQ(set({4, 1, 2}), EPIPE);
  EXPECT_TRUE(model_.set_.empty());
}

TEST_P(UhidRequestTest, AReportThatIsAskedForIsSpoiltAsOthersAre) {
  const int before = GetParam() ? 0 : 1;  // the kernel's byte for the number
  bench_.misbehaviour.shorten(1);
  EXPECT_EQ(get(3).size, before + 1);
  bench_.misbehaviour.babble(1);
  EXPECT_EQ(get(3).size, before + 5);
  bench_.misbehaviour.corrupt(1);
  const auto turned = get(3);
  EXPECT_EQ(turned.size, before + 2);
  EXPECT_FALSE(turned.data[before] == 3 && turned.data[before + 1] == 0xAB);
  EXPECT_EQ(get(3).data[before + 1], 0xAB) << "one each";
  bench_.misbehaviour.shorten(1);
  EXPECT_EQ(get(10).err, EPIPE);
  EXPECT_EQ(bench_.misbehaviour.struck().shortened, 1U) << "none is no report";
}

INSTANTIATE_TEST_SUITE_P(Numbers, UhidRequestTest, ::testing::Bool());

TEST(UhidPlugOfAnArm, CarriesTheExchangeOfTheBoard) {
  ExportBench bench;
  FakeUhid kernel;
  PhantomArmModel arm(phantom_vintage_parameters(), {.amplifier_max_a = 3});
  UhidPlug sut(kernel.take_device_end(), arm, arm.describe(), bench.surroundings());
  ASSERT_TRUE(sut.plug());
  kernel.say(UHID_OPEN);
  bench.run_frames(1100);  // it boots for a second
  EXPECT_EQ(kernel.last_input()->size, 14);
  for (int i = 0; i < 100; ++i) {
    kernel.write_output({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    bench.run_frames(1);
  }
  EXPECT_GT(sut.counters().to_host, 30U) << "one report for each that it was sent";
  EXPECT_NE(bench.lines().find("\"tip_m\""), std::string::npos);
}

}  // namespace
}  // namespace thimble::sim
