// The enumerator of the machine under the suite: the real libudev on a machine that umockdev
// invents, a stand-in for hidapi behind its nodes. Over a real kernel it is for the VM tier to run.
#include <poll.h>

#include <deque>

#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "tests/contract/bus_enumerator_contract.hpp"
#include "tests/support/fake_hidapi.hpp"
#include "tests/support/mock_machine.hpp"

namespace thimble::test {
namespace {

class LinuxBusRig final : public BusRig {
 public:
  LinuxBusRig() { replug(); }
  linux::BusEnumerator& buses() override {
    if (buses_ == nullptr) {
      buses_ = std::make_unique<linux::BusEnumerator>(linux::BusSettings{clock_, {}, {}});
    }
    return *buses_;
  }
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
  void settle() override { buses().catch_up(std::chrono::seconds(20)); }
  bool comes_true(const std::function<bool()>& claim) override {
    for (int i = 0; i < 20'000 && !claim(); ++i) ::poll(nullptr, 0, 1);
    return claim();
  }

 private:
  linux::MonotonicClock clock_;
  MockMachine machine_;
  std::deque<FakeHidWire> wires_;
  std::string path_;
  std::unique_ptr<linux::BusEnumerator> buses_;
};

std::unique_ptr<BusRig> make() { return std::make_unique<LinuxBusRig>(); }

INSTANTIATE_TEST_SUITE_P(Linux, BusEnumeratorContract,
                         testing::Values(BusRigFactory{"BusEnumerator", &make}), bus_rig_name);

}  // namespace
}  // namespace thimble::test
