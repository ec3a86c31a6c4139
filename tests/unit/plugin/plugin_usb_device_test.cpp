#include "hal/plugin/plugin_usb_device.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/support/open_limiter.hpp"

namespace thimble::plugin {
namespace {

constexpr std::uint8_t kIn = 0x81;
constexpr std::uint8_t kOut = 0x02;
const std::vector<std::uint8_t> kZero{7, 0, 0};

// A bus that keeps what it was given, and is there until the test says otherwise.
class KeptPipes final : public bus::UsbDevice {
 public:
  struct Kept {
    std::vector<std::vector<std::uint8_t>> sent;
    bool is_gone{false};
    bool is_deaf{false};
  };
  explicit KeptPipes(Kept& kept) : kept_(kept) {}
  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    if (kept_.is_gone) return IoStatus::Disconnected;
    if (endpoint != kIn) return IoStatus::ProtocolError;
    out.size = 1;
    out.arrived_at = MonotonicTime{std::chrono::seconds(1)};
    out.sequence = ++sequence_;
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    if (kept_.is_gone) return IoStatus::Disconnected;
    if (endpoint != kOut) return IoStatus::ProtocolError;
    if (kept_.is_deaf) return IoStatus::Backlogged;
    kept_.sent.emplace_back(packet.begin(), packet.end());
    return IoStatus::Ok;
  }
  IoStatus start_control(const bus::UsbControlRequest& /*request*/) noexcept override {
    return kept_.is_gone ? IoStatus::Disconnected : IoStatus::Ok;
  }
  IoStatus read_control(bus::UsbControlReply& /*out*/) noexcept override {
    return kept_.is_gone ? IoStatus::Disconnected : IoStatus::NoData;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t /*endpoint*/) const noexcept override {
    return {};
  }

 private:
  Kept& kept_;
  std::uint64_t sequence_{0};
};

// What the plugin answers, and the bus that it was given.
struct Script {
  const thimble_usb_bus* bus{nullptr};
  std::int32_t read{THIMBLE_OK};
  std::int32_t write{THIMBLE_OK};
  bool asks_the_bus{true};
  bool sends_when_closed{false};
  std::uint64_t samples{0};
  int forgotten{0};
  int closed{0};
};
Script& script_of(void* device) { return *static_cast<Script*>(device); }

std::int32_t read_sample(void* device, thimble_usb_sample* sample) {
  Script& script = script_of(device);
  if (script.asks_the_bus) {
    thimble_usb_packet packet{};
    const std::int32_t status = script.bus->read(script.bus->context, kIn, &packet);
    if (status != THIMBLE_OK) return status;
    sample->sampled_at_ns = packet.arrived_at_ns;
  }
  sample->state.calibration = THIMBLE_CALIBRATION_DONE;
  for (int i = 0; i < 3; ++i) sample->state.motor_current_a_per_newton[i][i] = 0.4;
  sample->sequence = ++script.samples;
  return script.read;
}

std::int32_t write_wrench(void* device, const thimble_wrench* wrench) {
  Script& script = script_of(device);
  if (script.write != THIMBLE_OK) return script.write;
  const std::uint8_t packet[3] = {7, static_cast<std::uint8_t>(10 * wrench->force_newton[0]), 1};
  return script.bus->submit(script.bus->context, kOut, packet, sizeof(packet));
}

thimble_usb_driver scripted_driver() {
  thimble_usb_driver driver{};
  driver.struct_bytes = sizeof(driver);
  driver.claim.pipe_count = 2;
  driver.claim.pipes[0].endpoint = kIn;
  driver.claim.pipes[1].endpoint = kOut;
  driver.close = [](void* device) {
    Script& script = script_of(device);
    ++script.closed;
    const std::uint8_t packet[3] = {7, 20, 1};
    if (script.sends_when_closed) {
      script.bus->submit(script.bus->context, kOut, packet, sizeof(packet));
    }
  };
  driver.forget_calibration = [](void* device) { ++script_of(device).forgotten; };
  driver.read = &read_sample;
  driver.write = &write_wrench;
  driver.read_instruction = [](void*, thimble_reason*) {};
  return driver;
}

struct PluginUsb : testing::Test {
  KeptPipes::Kept kept;
  Script script;
  thimble_usb_driver driver = scripted_driver();
  std::unique_ptr<PluginUsbDevice> sut = make();
  HapticState state;

  std::unique_ptr<PluginUsbDevice> make(bool has_zero = true) {
    auto bus = std::make_unique<PluginUsbBus>(std::make_unique<KeptPipes>(kept));
    script.bus = &bus->table();
    HapticCapabilities can;
    can.joint_count = 3;
    can.peak_current_a = {3, 3, 3};
    std::optional<ZeroCommand> zero;
    if (has_zero) {
      zero.emplace();
      zero->endpoint = kOut;
      for (const std::uint8_t byte : kZero) zero->bytes.push_back(byte);
    }
    return std::make_unique<PluginUsbDevice>(
        PluginUsbDevice::Parts{&driver, &script, std::move(bus), can, zero});
  }
  void push() {
    ASSERT_EQ(sut->read(state), IoStatus::Ok);
    ASSERT_EQ(sut->write(test::wrench_for({2, 0, 0}, *sut, state)), IoStatus::Ok);
    ASSERT_EQ(kept.sent.back()[1], 20);
  }
};

TEST_F(PluginUsb, ThatMayHoldAForceIsNotGoneBecauseThePluginSaysSo) {
  push();
  script.read = script.write = THIMBLE_DISCONNECTED;
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
  EXPECT_EQ(kept.sent.back(), kZero) << "and its force is taken away, whoever gives it up";
  EXPECT_EQ(sut->write(LimitedWrench::zero()), IoStatus::ProtocolError);
  EXPECT_EQ(sut->counters().malformed, 2U);
  EXPECT_EQ(sut->read(state), IoStatus::Disconnected) << "three were taken: it may be opened anew";
}

TEST_F(PluginUsb, ThatTakesNoZeroIsNotGoneAsLongAsItDoesNot) {
  push();
  script.read = THIMBLE_DISCONNECTED;
  kept.is_deaf = true;
  for (int i = 0; i < 100; ++i) ASSERT_EQ(sut->read(state), IoStatus::ProtocolError);
  kept.is_deaf = false;
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
}

TEST_F(PluginUsb, ThatIsToldAForceAgainIsAskedAnew) {
  push();
  script.read = THIMBLE_DISCONNECTED;
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
  script.read = THIMBLE_OK;
  push();
  script.read = THIMBLE_DISCONNECTED;
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
  EXPECT_EQ(sut->read(state), IoStatus::Disconnected);
}

// As one that gives up a boot that does not come to its end: it is opened anew.
TEST_F(PluginUsb, ThatWasToldNoForceIsGoneWhenThePluginSaysSo) {
  ASSERT_EQ(sut->read(state), IoStatus::Ok);
  script.read = THIMBLE_DISCONNECTED;
  EXPECT_EQ(sut->read(state), IoStatus::Disconnected);
  EXPECT_TRUE(kept.sent.empty());
}

// One that says it for good asks its bus nothing any more.
TEST_F(PluginUsb, WhosePluginAsksNothingIsGoneWhenItIsPulled) {
  push();
  script.asks_the_bus = false;
  script.read = script.write = THIMBLE_DISCONNECTED;
  kept.is_gone = true;
  EXPECT_EQ(sut->read(state), IoStatus::Disconnected);
  EXPECT_EQ(sut->write(LimitedWrench::zero()), IoStatus::Disconnected);
}

TEST_F(PluginUsb, IsGoneOnceItsBusHasSaidSo) {
  push();
  kept.is_gone = true;
  EXPECT_EQ(sut->read(state), IoStatus::Disconnected);
  EXPECT_EQ(sut->write(LimitedWrench::zero()), IoStatus::Disconnected);
  EXPECT_EQ(script.forgotten, 1);
  EXPECT_EQ(sut->counters().malformed, 0U);
}

TEST_F(PluginUsb, ThatWasToldAForceIsTakenItAwayWhenItIsClosedWhateverThePluginDoes) {
  push();
  script.read = THIMBLE_DISCONNECTED;
  EXPECT_EQ(sut->read(state), IoStatus::ProtocolError);
  script.sends_when_closed = true;
  sut.reset();
  ASSERT_GE(kept.sent.size(), 3U);
  EXPECT_EQ(kept.sent[kept.sent.size() - 3], kZero);
  EXPECT_EQ(kept.sent[kept.sent.size() - 2][1], 20) << "the plugin's";
  EXPECT_EQ(kept.sent.back(), kZero) << "the newest wins";
  EXPECT_EQ(script.closed, 1);
}

// It may be in the middle of an upload.
TEST_F(PluginUsb, ThatWasToldNoForceHearsNothingWhenItIsClosed) {
  ASSERT_EQ(sut->read(state), IoStatus::Ok);
  ASSERT_EQ(sut->write(LimitedWrench::zero()), IoStatus::Ok);
  const std::size_t before = kept.sent.size();
  sut.reset();
  EXPECT_EQ(kept.sent.size(), before);
}

TEST_F(PluginUsb, WithoutAZeroIsClosedByItsPluginAlone) {
  sut = make(false);
  push();
  const std::size_t before = kept.sent.size();
  sut.reset();
  EXPECT_EQ(kept.sent.size(), before);
  EXPECT_EQ(script.closed, 2) << "the one before it, too";
}

}  // namespace
}  // namespace thimble::plugin
