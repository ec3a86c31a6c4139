// The simulated serial line, bare, slow and behind a cable without faults, under its contract
// suite.
#include "sim/bus/sim_enumerator.hpp"
#include "sim/fault/faulty_enumerator.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/serial_port_contract.hpp"
#include "tests/support/scripted_serial_model.hpp"

namespace thimble::test {
namespace {

class SimSerialRig final : public SerialRig {
 public:
  SimSerialRig(std::uint32_t bit_per_s, bool is_behind_cable) {
    script_->bit_per_s = bit_per_s;
    EXPECT_TRUE(buses_.plug(address_, std::make_unique<ScriptedSerialModel>(script_)).has_value());
    bus::BusEnumerator& plain = buses_;
    bus::BusEnumerator& cable = faulty_;
    bus::SerialLine line;
    if (bit_per_s > 0) line.bit_per_s = bit_per_s;
    port_ = (is_behind_cable ? cable : plain).open_serial(address_, line).value();
  }
  bus::SerialPort& port() override { return *port_; }
  void close_port() override { port_.reset(); }
  void device_sends(const Bytes& bytes) override {
    script_->to_send.insert(script_->to_send.end(), bytes.begin(), bytes.end());
  }
  Bytes received_by_device() override { return script_->received; }
  void set_deaf(bool is_deaf) override { script_->is_deaf = is_deaf; }
  void unplug() override { EXPECT_TRUE(buses_.unplug(address_).has_value()); }
  void run_for(Duration duration) override { clock_.run_for(duration); }

 private:
  const bus::DeviceAddress address_{"sim:scripted"};
  sim::VirtualClock clock_;
  sim::SimEnumerator buses_{clock_};
  sim::FaultyEnumerator faulty_{buses_, clock_};
  std::shared_ptr<SerialModelScript> script_ = std::make_shared<SerialModelScript>();
  std::unique_ptr<bus::SerialPort> port_;
};

template <std::uint32_t kBitPerS, bool kIsBehindCable>
std::unique_ptr<SerialRig> make() {
  return std::make_unique<SimSerialRig>(kBitPerS, kIsBehindCable);
}

INSTANTIATE_TEST_SUITE_P(Bus, SerialPortContract,
                         testing::Values(SerialRigFactory{"SimAcm", &make<0, false>},
                                         SerialRigFactory{"SimLine", &make<3'000'000, false>},
                                         SerialRigFactory{"FaultySerial", &make<0, true>}),
                         serial_rig_name);

}  // namespace
}  // namespace thimble::test
