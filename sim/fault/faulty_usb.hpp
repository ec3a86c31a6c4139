#pragma once

#include <memory>
#include <span>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/usb_mailboxes.hpp"
#include "sim/fault/fault_dice.hpp"
#include "sim/fault/fault_plan.hpp"
#include "sim/fault/faulty_usb_pipes.hpp"

namespace thimble::sim {

// Any USB device behind a bad cable: passes everything on, but for what the plan says.
//
// Each endpoint throws dice of its own; the number of a packet is that of its endpoint. In: a
// delayed packet is stamped with the time at which it is let through, packets never overtake each
// other, and a lost one leaves no gap in `sequence`. Out: a delayed packet keeps the pipe busy, and
// the newest waits behind it; what may leave goes with the first call after its time. Stall means
// that the device says Nak to everything: nothing is lost by it but what is superseded. A dropped
// request never ends. Of requests, DelayOut, DropOut, Halt and CorruptOut act on their way out,
// DropIn, Babble, CorruptIn and TruncateIn on the answer. A short packet out is TruncateOut: the
// device gets the beginning, and writes_cut tells.
//
// Thread: as UsbDevice. RT: THIMBLE_RT_IO, as the device below; no allocation.
// Ownership: owns the device below. The clock must outlive it and be the one that stamps the
// packets below.
// Errors: as the device below; Disconnect latches.
class FaultyUsb final : public bus::UsbDevice {
 public:
  // `pipes` are those that `device` was opened with.
  FaultyUsb(std::unique_ptr<bus::UsbDevice> device, std::span<const bus::UsbOpenPipe> pipes,
            const Clock& clock, const FaultPlan& plan,
            const std::shared_ptr<FaultTally>& tally = std::make_shared<FaultTally>());

  THIMBLE_RT_IO IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::uint8_t endpoint,
                                std::span<const std::uint8_t> packet) noexcept override;
  THIMBLE_RT_IO IoStatus start_control(const bus::UsbControlRequest& request) noexcept override;
  THIMBLE_RT_IO IoStatus read_control(bus::UsbControlReply& out) noexcept override;
  // As its user sees them: a dropped packet is neither in nor skipped, a write that was dropped
  // here went out.
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override;
  [[nodiscard]] FaultCounts injected() const noexcept { return dice_.tally().read(); }

 private:
  // Lets through what waits; false when the device is gone.
  [[nodiscard]] bool serve(MonotonicTime now) noexcept;
  // What the device below said, and from now on for good if it is gone.
  IoStatus latched(IoStatus status) noexcept;

  std::unique_ptr<bus::UsbDevice> device_;
  const Clock* clock_;
  FaultDice dice_;  // of what concerns the whole device
  std::vector<std::unique_ptr<FaultyUsbIn>> ins_;
  std::vector<std::unique_ptr<FaultyUsbOut>> outs_;
  FaultyUsbControl control_;
  bool is_disconnected_{false};
};

}  // namespace thimble::sim
