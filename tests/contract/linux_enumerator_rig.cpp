// The enumerator of the machine under the suite, with a device of each kind: the real libudev on a
// machine that umockdev invents, behind its nodes a stand-in for hidapi, one for libusb, and a
// terminal of the kernel's own. Over a real kernel it is for the VM tier to run.
#include <poll.h>

#include <deque>
#include <string>

#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/contract/bus_enumerator_contract.hpp"
#include "tests/contract/pseudo_terminal.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/fake_libusb.hpp"
#include "tests/support/mock_machine.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::test {
namespace {

// Of which a derived one says how its device is plugged in and what stands behind its node.
class LinuxBusRig : public BusRig {
 public:
  linux::BusEnumerator& buses() override {
    if (buses_ == nullptr) {
      buses_ = std::make_unique<linux::BusEnumerator>(linux::BusSettings{clock_, {}, {}});
    }
    return *buses_;
  }
  void settle() override { buses().catch_up(std::chrono::seconds(20)); }
  bool comes_true(const std::function<bool()>& claim) override {
    for (int i = 0; i < 20'000 && !claim(); ++i) ::poll(nullptr, 0, 1);
    return claim();
  }

 protected:
  void close_buses() { buses_.reset(); }

  MockMachine machine_;
  std::string path_;

 private:
  linux::MonotonicClock clock_;
  std::unique_ptr<linux::BusEnumerator> buses_;
};

class LinuxHidBusRig final : public LinuxBusRig {
 public:
  LinuxHidBusRig() { LinuxHidBusRig::replug(); }
  // The bus first: what a stalled machine closes late still leads to a wire.
  ~LinuxHidBusRig() override { close_buses(); }
  LinuxHidBusRig(const LinuxHidBusRig&) = delete;
  LinuxHidBusRig& operator=(const LinuxHidBusRig&) = delete;
  bus::DeviceAddress address() const override { return {"hid:ABC1"}; }
  void unplug() override {
    wires_.back().unplug();
    machine_.unplug(path_);
  }
  // On no USB, where it would be two devices. The node's number goes up, as the kernel's does while
  // somebody holds the old one.
  void replug() override {
    const int number = static_cast<int>(wires_.size());
    wires_.emplace_back().attach("/dev/hidraw" + std::to_string(number));
    path_ = machine_.plug_virtual({.node_number = number,
                                   .instance = "000" + std::to_string(number + 1),
                                   .serial_number = "ABC1",
                                   .report_descriptor = plain_report_descriptor(14, 14)});
  }

 private:
  std::deque<FakeHidWire> wires_;
};

class LinuxUsbBusRig final : public LinuxBusRig {
 public:
  LinuxUsbBusRig() { LinuxUsbBusRig::replug(); }
  ~LinuxUsbBusRig() override {
    for (const FakeUsbWire& wire : wires_) EXPECT_EQ(wire.breaches(), std::vector<std::string>{});
    EXPECT_EQ(FakeUsbWire::alive(), 0);
  }
  LinuxUsbBusRig(const LinuxUsbBusRig&) = delete;
  LinuxUsbBusRig& operator=(const LinuxUsbBusRig&) = delete;

  bus::DeviceAddress address() const override { return {"usb:pci-0000:00:14.0-usb-0:4"}; }
  bus::BusKind kind() const override { return bus::BusKind::Usb; }
  void unplug() override {
    wires_.back().unplug();
    machine_.unplug(path_);
  }
  // The kernel gives each a number of its own.
  void replug() override {
    const int number = 4 + static_cast<int>(wires_.size());
    path_ =
        machine_.plug(MockMachine::UsbDevice{.number = number, .descriptors = bulk_descriptors()});
    wires_.emplace_back(std::make_unique<ScriptedUsbModel>(std::make_shared<UsbModelScript>()))
        .attach("/dev/bus/usb/001/00" + std::to_string(number));
  }

 private:
  std::deque<FakeUsbWire> wires_;
};

class LinuxSerialBusRig final : public LinuxBusRig {
 public:
  LinuxSerialBusRig() { LinuxSerialBusRig::replug(); }
  bus::DeviceAddress address() const override { return {"serial:ABC1"}; }
  bus::BusKind kind() const override { return bus::BusKind::Serial; }
  void unplug() override {
    lines_.back().unplug();
    machine_.unplug(path_);
  }
  void replug() override {
    const std::string node = "ttyACM" + std::to_string(lines_.size());
    path_ = machine_.plug(MockMachine::UsbDevice{.serial_number = "ABC1",
                                                 .number = 4 + static_cast<int>(lines_.size())});
    machine_.plug(
        MockMachine::SerialDevice{.name = node, .terminal = lines_.emplace_back().node()});
  }

 private:
  std::deque<PseudoTerminal> lines_;
};

template <class Rig>
std::unique_ptr<BusRig> make_bus_rig() {
  return std::make_unique<Rig>();
}

INSTANTIATE_TEST_SUITE_P(Linux, BusEnumeratorContract,
                         testing::Values(BusRigFactory{"Hid", &make_bus_rig<LinuxHidBusRig>},
                                         BusRigFactory{"Usb", &make_bus_rig<LinuxUsbBusRig>},
                                         BusRigFactory{"Serial", &make_bus_rig<LinuxSerialBusRig>}),
                         bus_rig_name);

}  // namespace
}  // namespace thimble::test
