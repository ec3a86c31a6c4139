#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hal/bus/bus_enumerator.hpp"
#include "tests/vm/replay/transcript.hpp"

namespace thimble::replay {

// Who lets time pass until a device has answered.
enum class Pace : std::uint8_t {
  Virtual,  // nobody has to: a simulated bus runs between two ticks
  Waits,    // a read waits for the answer to what was sent last, as long as it takes
};

// Another bus, of whose devices one answers each thing that it is sent with one report: those of
// TapeHid and TapeUsb, or of any kind at Pace::Virtual. Every report is stamped with the time of
// the clock at which it is read, and counted anew, so that the driver above sees the same on every
// bus. Both ways are written down.
//
// Thread: one, that of the servo. Not RT: it waits, and it allocates. Ownership: all must outlive
// it. Errors: as the bus; an answer that does not come in kPatience is a cable that was pulled.
class SteppedBus final : public bus::BusEnumerator {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(30);

  // `clock`: of the reports. `machine`: to wait on.
  SteppedBus(bus::BusEnumerator& buses, const Clock& clock, Clock& machine, Pace pace,
             Transcript& transcript)
      : buses_(&buses), clock_(&clock), machine_(&machine), pace_(pace), transcript_(&transcript) {}

  [[nodiscard]] std::vector<bus::BusDeviceInfo> list() override { return buses_->list(); }
  [[nodiscard]] std::optional<bus::BusEvent> poll_event() override { return buses_->poll_event(); }
  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid(
      const bus::DeviceAddress& address) override;
  [[nodiscard]] Result<std::unique_ptr<bus::UsbDevice>> open_usb(
      const bus::DeviceAddress& address, const bus::UsbClaim& claim) override;

 private:
  class Hid;
  class Usb;
  // Looks until `is_there`; false when patience has ended.
  template <typename Condition>
  bool wait_until(Condition is_there) const;

  bus::BusEnumerator* buses_;
  const Clock* clock_;
  Clock* machine_;
  Pace pace_;
  Transcript* transcript_;
};

}  // namespace thimble::replay
