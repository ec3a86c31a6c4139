// The enumerator of this machine under its suite, on a device of bare USB and on a serial port: the
// real libudev, libusb and termios over the kernel's own USB stack and cdc_acm.
#include <boost/asio/io_context.hpp>
#include <cstdlib>
#include <string>

#include "sim/export/acm_on_usb.hpp"
#include "sim/export/vhci_controller.hpp"
#include "sim/export/vhci_plug.hpp"
#include "tests/contract/bus_enumerator_contract.hpp"
#include "tests/contract/kernel_cable.hpp"
#include "tests/support/scripted_serial_model.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::test {
namespace {

const std::string kSerial = "CONTRACT-3";

class UsbEnd {
 public:
  static constexpr bus::BusKind kKind = bus::BusKind::Usb;
  plugin::SimUsbModel& model() { return model_; }
  [[nodiscard]] sim::UsbPersona persona() const {
    bus::BusDeviceInfo info = model_.describe();
    info.serial_number = kSerial;
    std::erase_if(info.endpoints,
                  [](const auto& endpoint) { return endpoint.interface_number != 0; });
    return {std::move(info), {}};
  }

 private:
  ScriptedUsbModel model_{std::make_shared<UsbModelScript>()};
};

class SerialEnd {
 public:
  static constexpr bus::BusKind kKind = bus::BusKind::Serial;
  plugin::SimUsbModel& model() { return modem_; }
  [[nodiscard]] sim::UsbPersona persona() const {
    bus::BusDeviceInfo info = serial_.describe();
    info.serial_number = kSerial;
    return modem_.persona(info);
  }

 private:
  ScriptedSerialModel serial_{std::make_shared<SerialModelScript>()};
  sim::AcmOnUsb modem_{serial_};
};

template <class End>
class KernelUsbStackRig final : public BusRig {
 public:
  KernelUsbStackRig() {
    cable_.start();
    replug();
  }
  // The next test's device must not be taken for this one.
  ~KernelUsbStackRig() override {
    if (cable_.alone([this] { return plug_.is_plugged(); })) unplug();
    cable_.stop();
  }
  KernelUsbStackRig(const KernelUsbStackRig&) = delete;
  KernelUsbStackRig& operator=(const KernelUsbStackRig&) = delete;

  bus::BusEnumerator& buses() override { return cable_.buses(); }
  bus::DeviceAddress address() const override { return address_; }
  bus::BusKind kind() const override { return End::kKind; }
  void unplug() override {
    cable_.alone([this] { EXPECT_TRUE(plug_.unplug(sim::Supply::Goes).has_value()); });
    EXPECT_TRUE(cable_.comes_true([this] { return !cable_.lists(address_); }));
  }
  void replug() override {
    cable_.alone([this] { EXPECT_TRUE(plug_.plug().has_value()); });
    EXPECT_TRUE(cable_.comes_true([this] { return cable_.lists(address_); }));
  }
  // udevd tells when it has applied its rules.
  void settle() override {
    EXPECT_EQ(std::system("udevadm settle"), 0);
    cable_.run_for(std::chrono::milliseconds(1));
    cable_.buses().catch_up(std::chrono::seconds(20));
  }
  bool comes_true(const std::function<bool()>& claim) override { return cable_.comes_true(claim); }

 private:
  const bus::DeviceAddress address_{(End::kKind == bus::BusKind::Usb ? "usb:" : "serial:") +
                                    kSerial};
  KernelCable cable_{std::chrono::milliseconds(1)};
  End end_;
  boost::asio::io_context io_;
  sim::VhciPlug plug_{
      io_, end_.model(), end_.persona(), cable_.surroundings(),
      [](int socket, std::uint32_t id) { return sim::VhciController().attach(socket, id); }};
};

template <class Rig>
std::unique_ptr<BusRig> make() {
  return std::make_unique<Rig>();
}

INSTANTIATE_TEST_SUITE_P(KernelUsbStack, BusEnumeratorContract,
                         testing::Values(BusRigFactory{"Usbfs", &make<KernelUsbStackRig<UsbEnd>>},
                                         BusRigFactory{"CdcAcm",
                                                       &make<KernelUsbStackRig<SerialEnd>>}),
                         bus_rig_name);

}  // namespace
}  // namespace thimble::test
