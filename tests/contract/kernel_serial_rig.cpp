// A serial port of this machine under its suite: the kernel's own cdc_acm, on a modem that hangs on
// its USB stack, found by libudev as any other.
#include <boost/asio/io_context.hpp>
#include <string>

#include "sim/export/acm_on_usb.hpp"
#include "sim/export/vhci_controller.hpp"
#include "sim/export/vhci_plug.hpp"
#include "tests/contract/kernel_cable.hpp"
#include "tests/contract/serial_port_contract.hpp"
#include "tests/support/scripted_serial_model.hpp"

namespace thimble::test {
namespace {

const std::string kSerial = "CONTRACT-2";
const bus::DeviceAddress kAddress{"serial:" + kSerial};

// The modem, deaf at its plug: AcmOnUsb itself takes one packet for a model that takes none.
class DeafAtWill final : public plugin::SimUsbModel {
 public:
  explicit DeafAtWill(plugin::SimSerialModel& model) : modem_(model) {}
  [[nodiscard]] sim::UsbPersona persona(const bus::BusDeviceInfo& info) const {
    return modem_.persona(info);
  }
  void set_deaf(bool is_deaf) { is_deaf_ = is_deaf; }

  [[nodiscard]] bus::BusDeviceInfo describe() const override { return modem_.describe(); }
  void advance(MonotonicTime t) noexcept override { modem_.advance(t); }
  plugin::UsbAnswer control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept override {
    return modem_.control(request, in);
  }
  plugin::UsbHandshake out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept override {
    return is_deaf_ ? plugin::UsbHandshake::Nak : modem_.out_packet(endpoint, bytes);
  }
  plugin::UsbAnswer in_packet(std::uint8_t endpoint,
                              std::span<std::uint8_t> out) noexcept override {
    return modem_.in_packet(endpoint, out);
  }
  void power_cycle() noexcept override { modem_.power_cycle(); }
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override { return nullptr; }

 private:
  sim::AcmOnUsb modem_;
  bool is_deaf_{false};
};

bus::BusDeviceInfo named(bus::BusDeviceInfo info) {
  info.serial_number = kSerial;
  return info;
}

class KernelSerialRig final : public SerialRig {
 public:
  KernelSerialRig() {
    cable_.start();
    cable_.alone([this] { EXPECT_TRUE(plug_.plug().has_value()); });
    EXPECT_TRUE(cable_.comes_true([this] { return cable_.lists(kAddress); }));
    EXPECT_TRUE(cable_.comes_true([this] {
      auto opened = cable_.buses().open_serial(kAddress, {});
      if (opened) port_ = *std::move(opened);
      return port_ != nullptr;
    }));
  }
  // The next test's device must not be taken for this one.
  ~KernelSerialRig() override {
    port_.reset();
    if (cable_.alone([this] { return plug_.is_plugged(); })) unplug();
    cable_.stop();
  }
  KernelSerialRig(const KernelSerialRig&) = delete;
  KernelSerialRig& operator=(const KernelSerialRig&) = delete;

  bus::SerialPort& port() override { return *port_; }
  void close_port() override { port_.reset(); }
  bool has_kernel() const override { return true; }
  void device_sends(const Bytes& bytes) override {
    cable_.alone(
        [&] { script_->to_send.insert(script_->to_send.end(), bytes.begin(), bytes.end()); });
  }
  Bytes received_by_device() override {
    return cable_.alone([this] { return script_->received; });
  }
  void set_deaf(bool is_deaf) override {
    cable_.alone([&] { model_.set_deaf(is_deaf); });
  }
  void unplug() override {
    cable_.alone([this] { EXPECT_TRUE(plug_.unplug(sim::Supply::Goes).has_value()); });
    EXPECT_TRUE(cable_.comes_true([this] { return !cable_.lists(kAddress); }));
  }
  void run_for(Duration duration) override { cable_.run_for(duration); }

 private:
  KernelCable cable_{std::chrono::milliseconds(1)};
  std::shared_ptr<SerialModelScript> script_ = std::make_shared<SerialModelScript>();
  ScriptedSerialModel serial_{script_};
  DeafAtWill model_{serial_};
  boost::asio::io_context io_;
  sim::VhciPlug plug_{
      io_, model_, model_.persona(named(serial_.describe())), cable_.surroundings(),
      [](int socket, std::uint32_t id) { return sim::VhciController().attach(socket, id); }};
  std::unique_ptr<bus::SerialPort> port_;
};

std::unique_ptr<SerialRig> make() { return std::make_unique<KernelSerialRig>(); }

INSTANTIATE_TEST_SUITE_P(Kernel, SerialPortContract,
                         testing::Values(SerialRigFactory{"CdcAcm", &make}), serial_rig_name);

}  // namespace
}  // namespace thimble::test
