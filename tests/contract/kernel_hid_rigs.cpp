// HID devices of this machine under the suites: the real hidapi and libudev over the kernel's own
// uhid, and over its USB stack.
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <boost/asio/io_context.hpp>

#include "sim/export/hid_on_usb.hpp"
#include "sim/export/uhid_wire.hpp"
#include "sim/export/usbip_plug.hpp"
#include "tests/contract/bus_enumerator_contract.hpp"
#include "tests/contract/hid_device_contract.hpp"
#include "tests/contract/kernel_cable.hpp"
#include "tests/support/scripted_hid_model.hpp"

namespace thimble::test {
namespace {

constexpr Duration kFrame = ScriptedHidModel::kFrame;
const std::string kSerial = "CONTRACT-1";
const bus::DeviceAddress kAddress{"hid:" + kSerial};

// Reports of any length up to a packet are what the suite sends, so its device has whole packets.
class PacketModel final : public plugin::SimHidModel {
 public:
  explicit PacketModel(std::shared_ptr<HidModelScript> script) : scripted_(std::move(script)) {}
  [[nodiscard]] bus::BusDeviceInfo describe() const override {
    bus::BusDeviceInfo info = scripted_.describe();
    info.serial_number = kSerial;
    info.input_report_bytes = bus::kMaxHidReportBytes;
    return info;
  }
  [[nodiscard]] Duration frame_period() const noexcept override { return kFrame; }
  void advance(MonotonicTime t) noexcept override { scripted_.advance(t); }
  void out_report(std::span<const std::uint8_t> bytes) noexcept override {
    scripted_.out_report(bytes);
  }
  std::size_t in_report(std::span<std::uint8_t> out) noexcept override {
    return scripted_.in_report(out);
  }
  void power_cycle() noexcept override { scripted_.power_cycle(); }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  ScriptedHidModel scripted_;
};

// The far end of uhid. Not UhidPlug, which gives its model the newest report of a frame: the suite
// asks for every one.
class UhidEnd {
 public:
  UhidEnd(KernelCable& cable, std::shared_ptr<HidModelScript> script)
      : cable_(&cable), script_(std::move(script)), model_(script_) {
    node_ = linux::Descriptor(::open("/dev/uhid", O_RDWR | O_CLOEXEC | O_NONBLOCK));
    plug();
    cable.start([this] { frame(); });
  }
  ~UhidEnd() { cable_->stop(); }
  UhidEnd(const UhidEnd&) = delete;
  UhidEnd& operator=(const UhidEnd&) = delete;

  void plug() {
    write(sim::uhid::create(model_.describe(), model_.report_descriptor()));
    EXPECT_TRUE(cable_->comes_true([this] { return cable_->lists(kAddress); }));
  }
  void unplug() {
    cable_->alone([this] { write(sim::uhid::destroy()); });
    EXPECT_TRUE(cable_->comes_true([this] { return !cable_->lists(kAddress); }));
  }

 private:
  void write(const sim::uhid::Bytes& event) {
    EXPECT_EQ(::write(node_.get(), event.data(), event.size()), static_cast<ssize_t>(event.size()));
  }
  // hidraw puts a zero before reports that have no numbers, and uhid passes it on.
  void take(std::span<const std::uint8_t> bytes) {
    const auto report = bytes.subspan(bytes.empty() || bytes.front() != 0 ? 0 : 1);
    script_->received.emplace_back(report.begin(), report.end());
  }
  void frame() {
    std::array<std::uint8_t, sim::uhid::kEventBytes> bytes{};
    while (::read(node_.get(), bytes.data(), bytes.size()) > 0) {
      const auto event = sim::uhid::parse(bytes);
      const auto* output = event ? std::get_if<sim::uhid::Output>(&*event) : nullptr;
      if (output != nullptr) take(output->bytes);
      bytes.fill(0);
    }
    if (script_->to_send.empty()) return;
    write(sim::uhid::input(script_->to_send.front()));
    script_->to_send.pop_front();
  }

  KernelCable* cable_;
  std::shared_ptr<HidModelScript> script_;
  PacketModel model_;
  linux::Descriptor node_;
};

// The same device on the kernel's USB stack.
class UsbipEnd {
 public:
  UsbipEnd(KernelCable& cable, std::shared_ptr<HidModelScript> script)
      : cable_(&cable), model_(std::move(script)) {
    plug_ = sim::UsbipPlug::listen(io_, 0, on_usb_, on_usb_.persona(model_.describe()),
                                   cable.surroundings())
                .value();
    cable.start();
    plug();
  }
  ~UsbipEnd() { cable_->stop(); }
  UsbipEnd(const UsbipEnd&) = delete;
  UsbipEnd& operator=(const UsbipEnd&) = delete;

  void plug() {
    cable_->alone([this] { EXPECT_TRUE(plug_->plug().has_value()); });
    EXPECT_TRUE(attach_by_usbip(plug_->port()));
    EXPECT_TRUE(cable_->comes_true([this] { return cable_->lists(kAddress); }));
  }
  void unplug() {
    cable_->alone([this] { EXPECT_TRUE(plug_->unplug(sim::Supply::Goes).has_value()); });
    EXPECT_TRUE(cable_->comes_true([this] { return !cable_->lists(kAddress); }));
  }

 private:
  KernelCable* cable_;
  PacketModel model_;
  sim::HidOnUsb on_usb_{model_};
  boost::asio::io_context io_;
  std::unique_ptr<sim::UsbipPlug> plug_;
};

template <class End>
class KernelHidRig final : public HidRig {
 public:
  KernelHidRig() {
    EXPECT_TRUE(cable_.comes_true([this] {
      auto opened = cable_.buses().open_hid(kAddress);
      if (opened) device_ = *std::move(opened);
      return device_ != nullptr;
    }));
  }
  bus::HidDevice& device() override { return *device_; }
  void close_device() override { device_.reset(); }
  void device_sends(std::span<const std::uint8_t> report) override {
    cable_.alone([&] { script_->to_send.emplace_back(report.begin(), report.end()); });
  }
  std::vector<std::vector<std::uint8_t>> received_by_device() override {
    return cable_.alone([this] { return script_->received; });
  }
  void unplug() override { end_.unplug(); }
  void run_for(Duration duration) override { cable_.run_for(duration); }
  std::size_t input_report_bytes() const override { return bus::kMaxHidReportBytes; }
  std::size_t least_report_bytes() const override { return bus::kMaxHidReportBytes; }
  std::size_t output_report_bytes() const override { return ScriptedHidModel::kOutputBytes; }
  Duration frame_period() const override { return kFrame; }

 private:
  KernelCable cable_{kFrame};
  std::shared_ptr<HidModelScript> script_ = std::make_shared<HidModelScript>();
  End end_{cable_, script_};
  std::unique_ptr<bus::HidDevice> device_;
};

template <class End>
class KernelBusRig final : public BusRig {
 public:
  bus::BusEnumerator& buses() override { return cable_.buses(); }
  bus::DeviceAddress address() const override { return kAddress; }
  void unplug() override { end_.unplug(); }
  void replug() override { end_.plug(); }
  // udevd tells when it has applied its rules.
  void settle() override {
    EXPECT_EQ(std::system("udevadm settle"), 0);
    cable_.run_for(kFrame);
    cable_.buses().catch_up(std::chrono::seconds(20));
  }
  bool comes_true(const std::function<bool()>& claim) override { return cable_.comes_true(claim); }

 private:
  KernelCable cable_{kFrame};
  End end_{cable_, std::make_shared<HidModelScript>()};
};

template <class Interface, class Rig>
std::unique_ptr<Interface> make() {
  return std::make_unique<Rig>();
}

INSTANTIATE_TEST_SUITE_P(
    Kernel, HidDeviceContract,
    testing::Values(HidRigFactory{"Uhid", &make<HidRig, KernelHidRig<UhidEnd>>},
                    HidRigFactory{"Usbip", &make<HidRig, KernelHidRig<UsbipEnd>>}),
    rig_name);
INSTANTIATE_TEST_SUITE_P(
    Kernel, BusEnumeratorContract,
    testing::Values(BusRigFactory{"Uhid", &make<BusRig, KernelBusRig<UhidEnd>>},
                    BusRigFactory{"Usbip", &make<BusRig, KernelBusRig<UsbipEnd>>}),
    bus_rig_name);

}  // namespace
}  // namespace thimble::test
