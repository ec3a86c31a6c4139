#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "sim/bus/sim_port.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// The simulated bus: models plugged in under "sim:NAME", running on a virtual clock.
//
// Thread: plug() and destruction while nobody runs the clock; the rest from one control
// thread, while another may run the clock. Not RT, but the frames of its devices are.
// Ownership: owns the models. The clock must outlive it, and it the devices it opened.
// Frames: see SimHidPort, SimUsbPort and SimSerialPort.
class SimEnumerator final : public bus::BusEnumerator {
 public:
  explicit SimEnumerator(VirtualClock& clock) noexcept : clock_(&clock) {}

  // Announced as Arrived. Busy when the address is taken (unplugged or not);
  // InvalidArgument when the model has no frame period, or reports or packets longer than full
  // speed allows.
  Result<void> plug(const bus::DeviceAddress& address, std::unique_ptr<plugin::SimHidModel> model);
  Result<void> plug(const bus::DeviceAddress& address, std::unique_ptr<plugin::SimUsbModel> model);
  Result<void> plug(const bus::DeviceAddress& address,
                    std::unique_ptr<plugin::SimSerialModel> model);
  // On whichever bus the model is.
  Result<void> plug_any(const bus::DeviceAddress& address, plugin::SimModel model);
  // The cable is pulled, or put back: NotFound for an unknown address or when it was already.
  Result<void> unplug(const bus::DeviceAddress& address, Supply supply = Supply::Goes);
  Result<void> replug(const bus::DeviceAddress& address);

  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override;
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override;
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override;
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::DeviceAddress& address, const bus::UsbClaim& claim) override;
  [[nodiscard]] Result<std::unique_ptr<bus::SerialPort>> open_serial(
      const bus::DeviceAddress& address, const bus::SerialLine& line) override;

  // The other face of a model, plugged or not; nullptr when there is none.
  // Its verbs belong to the thread that runs the clock.
  [[nodiscard]] plugin::ArmBackend* arm_backend(const bus::DeviceAddress& address) noexcept;

 private:
  [[nodiscard]] Result<void> check_new(const bus::DeviceAddress& address, bool has_model) const;
  void add(std::unique_ptr<SimPort> port);
  // As it is now, with the number of its plugging.
  [[nodiscard]] bus::BusDeviceInfo describe(const SimPort& port) const;
  // nullptr: unknown, or plugged in anew since it was listed.
  [[nodiscard]] SimPort* find(const bus::DeviceAddress& address) noexcept;

  VirtualClock* clock_;
  std::map<bus::DeviceAddress, std::unique_ptr<SimPort>> ports_;
  std::map<bus::DeviceAddress, std::uint64_t> pluggings_;
  std::deque<bus::BusEvent> events_;
};

}  // namespace thimble::sim
