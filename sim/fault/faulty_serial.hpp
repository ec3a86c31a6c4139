#pragma once

#include <memory>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/serial_port.hpp"
#include "sim/fault/fault_dice.hpp"
#include "sim/fault/fault_plan.hpp"
#include "sim/fault/faulty_usb.hpp"

namespace thimble::sim {

// Any serial port behind a bad cable: passes everything on, but for what the plan says.
//
// A FaultyUsb of two pipes does it, of which see the details: a report of the plan is a chunk, as
// the bus below carved the stream, or a message. DropIn leaves a hole in the stream and none in
// `sequence`, as on a real line; Stall is a line that hangs, Disconnect a port that dies;
// TruncateOut lets the device have the beginning of a message, and writes_failed tells. Halt and
// Babble, which a line does not know, lose a chunk or message.
//
// Thread: as SerialPort. RT: THIMBLE_RT_IO, as the port below; no allocation.
// Ownership: owns the port below. The clock must outlive it and be the one that stamps the chunks
// below. Errors: as the port below; Disconnect latches.
class FaultySerial final : public bus::SerialPort {
 public:
  FaultySerial(std::unique_ptr<bus::SerialPort> port, const Clock& clock, const FaultPlan& plan,
               const std::shared_ptr<FaultTally>& tally = std::make_shared<FaultTally>());

  THIMBLE_RT_IO IoStatus read(bus::SerialChunk& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::span<const std::uint8_t> message) noexcept override;
  // As its user sees them; bytes are those of the port below.
  [[nodiscard]] bus::SerialCounters counters() const noexcept override;
  [[nodiscard]] FaultCounts injected() const noexcept { return cable_.injected(); }

 private:
  const bus::SerialPort* port_;  // behind the cable, which owns it
  FaultyUsb cable_;
  bus::UsbPacket packet_{};
};

}  // namespace thimble::sim
