// The simulated bus, bare and behind a cable without faults, under the contract suites.
#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/bus_enumerator_contract.hpp"
#include "tests/contract/hid_device_contract.hpp"
#include "tests/support/scripted_hid_model.hpp"

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
  explicit SimBusRig(bool is_behind_cable) : is_behind_cable_(is_behind_cable) {}
  bus::BusEnumerator& buses() override {
    if (is_behind_cable_) return sim_.faulty;
    return sim_.buses;
  }
  bus::DeviceAddress address() const override { return kAddress; }
  void unplug() override { EXPECT_TRUE(sim_.buses.unplug(kAddress).has_value()); }
  void replug() override { EXPECT_TRUE(sim_.buses.replug(kAddress).has_value()); }
  void settle() override { sim_.clock.run_for(ScriptedHidModel::kFrame * 3); }

 private:
  SimBus sim_;
  bool is_behind_cable_;
};

template <class Interface, class Rig, bool kIsBehindCable>
std::unique_ptr<Interface> make() {
  return std::make_unique<Rig>(kIsBehindCable);
}

INSTANTIATE_TEST_SUITE_P(Bus, HidDeviceContract,
                         testing::Values(HidRigFactory{"SimHid", &make<HidRig, SimHidRig, false>},
                                         HidRigFactory{"FaultyHid",
                                                       &make<HidRig, SimHidRig, true>}),
                         rig_name);
INSTANTIATE_TEST_SUITE_P(
    Bus, BusEnumeratorContract,
    testing::Values(BusRigFactory{"SimEnumerator", &make<BusRig, SimBusRig, false>},
                    BusRigFactory{"FaultyEnumerator", &make<BusRig, SimBusRig, true>}),
    bus_rig_name);

}  // namespace
}  // namespace thimble::test
