// The simulated bus, bare and behind a cable without faults, under the contract suites.
#include <memory>
#include <utility>

#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/bus_enumerator_contract.hpp"
#include "tests/contract/hid_device_contract.hpp"
#include "tests/support/scripted_hid_model.hpp"
#include "tests/support/scripted_serial_model.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::test {
namespace {

const bus::DeviceAddress kAddress{"sim:scripted"};

struct SimBus {
  sim::VirtualClock clock;
  sim::SimEnumerator buses{clock};
  sim::FaultyEnumerator faulty{buses, clock};
  std::shared_ptr<HidModelScript> script = std::make_shared<HidModelScript>();

  SimBus() {
    EXPECT_TRUE(buses.plug(kAddress, std::make_unique<ScriptedHidModel>(script)).has_value());
  }
};

class SimHidRig final : public HidRig {
 public:
  explicit SimHidRig(bool is_behind_cable) {
    bus::BusEnumerator& plain = sim_.buses;
    bus::BusEnumerator& cable = sim_.faulty;
    device_ = (is_behind_cable ? cable : plain).open_hid(kAddress).value();
  }
  bus::HidDevice& device() override { return *device_; }
  void close_device() override { device_.reset(); }
  void device_sends(std::span<const std::uint8_t> report) override {
    sim_.script->to_send.emplace_back(report.begin(), report.end());
  }
  std::vector<std::vector<std::uint8_t>> received_by_device() override {
    return sim_.script->received;
  }
  void unplug() override { EXPECT_TRUE(sim_.buses.unplug(kAddress).has_value()); }
  void run_for(Duration duration) override { sim_.clock.run_for(duration); }
  std::size_t input_report_bytes() const override { return ScriptedHidModel::kInputBytes; }
  std::size_t output_report_bytes() const override { return ScriptedHidModel::kOutputBytes; }
  Duration frame_period() const override { return ScriptedHidModel::kFrame; }

 private:
  SimBus sim_;
  std::unique_ptr<bus::HidDevice> device_;
};

class SimBusRig final : public BusRig {
 public:
  SimBusRig(bus::DeviceAddress address, bus::BusKind kind, plugin::SimModel model,
            bool is_behind_cable)
      : address_(std::move(address)), kind_(kind), is_behind_cable_(is_behind_cable) {
    EXPECT_TRUE(buses_.plug_any(address_, std::move(model)).has_value());
  }
  bus::BusEnumerator& buses() override {
    if (is_behind_cable_) return faulty_;
    return buses_;
  }
  bus::DeviceAddress address() const override { return address_; }
  bus::BusKind kind() const override { return kind_; }
  void unplug() override { EXPECT_TRUE(buses_.unplug(address_).has_value()); }
  void replug() override { EXPECT_TRUE(buses_.replug(address_).has_value()); }
  void settle() override { clock_.run_for(ScriptedHidModel::kFrame * 3); }

 private:
  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  sim::FaultyEnumerator faulty_{buses_, clock_};
  bus::DeviceAddress address_;
  bus::BusKind kind_;
  bool is_behind_cable_;
};

template <bool kIsBehindCable>
std::unique_ptr<HidRig> make_hid() {
  return std::make_unique<SimHidRig>(kIsBehindCable);
}

template <bool kIsBehindCable>
std::unique_ptr<BusRig> make_hid_bus() {
  return std::make_unique<SimBusRig>(
      kAddress, bus::BusKind::Hid,
      std::make_unique<ScriptedHidModel>(std::make_shared<HidModelScript>()), kIsBehindCable);
}

template <bool kIsBehindCable>
std::unique_ptr<BusRig> make_usb_bus() {
  return std::make_unique<SimBusRig>(
      bus::DeviceAddress{"usb:1-4"}, bus::BusKind::Usb,
      std::make_unique<ScriptedUsbModel>(std::make_shared<UsbModelScript>()), kIsBehindCable);
}

template <bool kIsBehindCable>
std::unique_ptr<BusRig> make_serial_bus() {
  return std::make_unique<SimBusRig>(
      bus::DeviceAddress{"serial:ABC1"}, bus::BusKind::Serial,
      std::make_unique<ScriptedSerialModel>(std::make_shared<SerialModelScript>()), kIsBehindCable);
}

INSTANTIATE_TEST_SUITE_P(Bus, HidDeviceContract,
                         testing::Values(HidRigFactory{"SimHid", &make_hid<false>},
                                         HidRigFactory{"FaultyHid", &make_hid<true>}),
                         rig_name);
INSTANTIATE_TEST_SUITE_P(Bus, BusEnumeratorContract,
                         testing::Values(BusRigFactory{"SimEnumerator", &make_hid_bus<false>},
                                         BusRigFactory{"FaultyEnumerator", &make_hid_bus<true>},
                                         BusRigFactory{"SimUsb", &make_usb_bus<false>},
                                         BusRigFactory{"FaultyUsb", &make_usb_bus<true>},
                                         BusRigFactory{"SimSerial", &make_serial_bus<false>},
                                         BusRigFactory{"FaultySerial", &make_serial_bus<true>}),
                         bus_rig_name);

}  // namespace
}  // namespace thimble::test
