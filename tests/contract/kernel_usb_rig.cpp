// A USB device of this machine under its suite: the real libusb and libudev over the kernel's own
// USB stack.
#include <algorithm>
#include <boost/asio/io_context.hpp>

#include "sim/export/usbip_plug.hpp"
#include "tests/contract/kernel_cable.hpp"
#include "tests/contract/usb_device_contract.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::test {
namespace {

// What is offered has one interface: the other, of which the suite asks that it is refused, is not
// there at all.
sim::UsbPersona persona_of(const ScriptedUsbModel& model) {
  bus::BusDeviceInfo info = model.describe();
  std::erase_if(info.endpoints,
                [](const auto& endpoint) { return endpoint.interface_number != 0; });
  return {std::move(info), {}};
}

class KernelUsbRig final : public UsbRig {
 public:
  KernelUsbRig() {
    plug_ =
        sim::UsbipPlug::listen(io_, 0, model_, persona_of(model_), cable_.surroundings()).value();
    cable_.start();
    cable_.alone([this] { EXPECT_TRUE(plug_->plug().has_value()); });
    EXPECT_TRUE(attach_by_usbip(plug_->port()));
    EXPECT_TRUE(cable_.comes_true([this] { return find(); }));
  }
  // The next test's device must not be taken for this one.
  ~KernelUsbRig() override {
    if (cable_.alone([this] { return plug_->is_plugged(); })) unplug();
    cable_.stop();
  }
  KernelUsbRig(const KernelUsbRig&) = delete;
  KernelUsbRig& operator=(const KernelUsbRig&) = delete;

  bus::BusEnumerator& buses() override { return cable_.buses(); }
  bus::DeviceAddress address() const override { return address_; }
  void run_for(Duration duration) override { cable_.run_for(duration); }
  void device_sends(std::uint8_t endpoint, const Packet& packet) override {
    cable_.alone([&] { script_->to_send[endpoint].push_back(packet); });
  }
  void device_answers_control(const Packet& data) override {
    cable_.alone([&] { script_->control_answer = data; });
  }
  void device_stalls_once(std::uint8_t endpoint) override {
    cable_.alone([&] { script_->stalls_to_come.insert(endpoint); });
  }
  void set_deaf(std::uint8_t endpoint, bool is_deaf) override {
    cable_.alone([&] {
      if (is_deaf) {
        script_->deaf.insert(endpoint);
      } else {
        script_->deaf.erase(endpoint);
      }
    });
  }
  std::vector<Packet> received_by_device(std::uint8_t endpoint) override {
    return cable_.alone([&] { return script_->received[endpoint]; });
  }
  std::vector<bus::UsbControlRequest> requests_of_device() override {
    return cable_.alone([this] { return script_->requests; });
  }
  void unplug() override {
    cable_.alone([this] { EXPECT_TRUE(plug_->unplug(sim::Supply::Goes).has_value()); });
    EXPECT_TRUE(cable_.comes_true([this] { return !find(); }));
  }

 private:
  // Which port the kernel gave it.
  bool find() {
    const bus::BusDeviceInfo wanted = model_.describe();
    const auto devices = cable_.buses().list();
    const auto found = std::find_if(devices.begin(), devices.end(), [&](const auto& info) {
      return info.vendor_id == wanted.vendor_id && info.product_id == wanted.product_id;
    });
    if (found == devices.end()) return false;
    address_ = found->address;
    return true;
  }

  KernelCable cable_{std::chrono::milliseconds(1)};
  std::shared_ptr<UsbModelScript> script_ = std::make_shared<UsbModelScript>();
  ScriptedUsbModel model_{script_};
  boost::asio::io_context io_;
  std::unique_ptr<sim::UsbipPlug> plug_;
  bus::DeviceAddress address_;
};

std::unique_ptr<UsbRig> make() { return std::make_unique<KernelUsbRig>(); }

INSTANTIATE_TEST_SUITE_P(Kernel, UsbDeviceContract, testing::Values(UsbRigFactory{"Usbip", &make}),
                         usb_rig_name);

}  // namespace
}  // namespace thimble::test
