// The simulated USB bus, bare and behind a cable without faults, under its contract suite.
#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/usb_device_contract.hpp"
#include "tests/support/scripted_usb_model.hpp"

namespace thimble::test {
namespace {

class SimUsbRig final : public UsbRig {
 public:
  explicit SimUsbRig(bool is_behind_cable) : is_behind_cable_(is_behind_cable) {
    EXPECT_TRUE(buses_.plug(address(), std::make_unique<ScriptedUsbModel>(script_)).has_value());
  }
  bus::BusEnumerator& buses() override {
    if (is_behind_cable_) return faulty_;
    return buses_;
  }
  bus::DeviceAddress address() const override { return {"sim:scripted"}; }
  void run_for(Duration duration) override { clock_.run_for(duration); }
  void device_sends(std::uint8_t endpoint, const Packet& packet) override {
    script_->to_send[endpoint].push_back(packet);
  }
  void device_answers_control(const Packet& data) override { script_->control_answer = data; }
  void device_stalls_once(std::uint8_t endpoint) override {
    script_->stalls_to_come.insert(endpoint);
  }
  void set_deaf(std::uint8_t endpoint, bool is_deaf) override {
    if (is_deaf) {
      script_->deaf.insert(endpoint);
    } else {
      script_->deaf.erase(endpoint);
    }
  }
  std::vector<Packet> received_by_device(std::uint8_t endpoint) override {
    return script_->received[endpoint];
  }
  std::vector<bus::UsbControlRequest> requests_of_device() override { return script_->requests; }
  void unplug() override { EXPECT_TRUE(buses_.unplug(address()).has_value()); }

 private:
  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  sim::FaultyEnumerator faulty_{buses_, clock_};
  bool is_behind_cable_;
  std::shared_ptr<UsbModelScript> script_ = std::make_shared<UsbModelScript>();
};

template <bool kIsBehindCable>
std::unique_ptr<UsbRig> make() {
  return std::make_unique<SimUsbRig>(kIsBehindCable);
}

INSTANTIATE_TEST_SUITE_P(Bus, UsbDeviceContract,
                         testing::Values(UsbRigFactory{"SimUsb", &make<false>},
                                         UsbRigFactory{"FaultyUsb", &make<true>}),
                         usb_rig_name);

}  // namespace
}  // namespace thimble::test
