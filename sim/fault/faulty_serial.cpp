#include "sim/fault/faulty_serial.hpp"

#include <algorithm>
#include <utility>

#include "hal/bus/serial_mailboxes.hpp"

namespace thimble::sim {
namespace {

// A serial port with the face of a USB device.
class SerialAsUsb final : public bus::UsbDevice {
 public:
  explicit SerialAsUsb(std::unique_ptr<bus::SerialPort> port) : port_(std::move(port)) {}

  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    if (endpoint != bus::kSerialIn) return IoStatus::ProtocolError;
    const IoStatus status = port_->read(chunk_);
    if (status != IoStatus::Ok) return status;
    std::copy_n(chunk_.bytes.begin(), chunk_.size, out.bytes.begin());
    out.size = chunk_.size;
    out.arrived_at = chunk_.arrived_at;
    out.sequence = chunk_.sequence;
    return status;
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    return endpoint == bus::kSerialOut ? port_->submit(packet) : IoStatus::ProtocolError;
  }
  IoStatus start_control(const bus::UsbControlRequest& /*request*/) noexcept override {
    return IoStatus::ProtocolError;
  }
  IoStatus read_control(bus::UsbControlReply& /*out*/) noexcept override {
    return IoStatus::NoData;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override {
    const bus::SerialCounters all = port_->counters();
    if (endpoint == bus::kSerialIn) {
      return {.packets_in = all.chunks_in, .packets_skipped = all.chunks_skipped};
    }
    return {.packets_out = all.messages_out,
            .writes_superseded = all.writes_superseded,
            .failures = all.writes_failed};
  }

 private:
  std::unique_ptr<bus::SerialPort> port_;
  bus::SerialChunk chunk_{};
};

}  // namespace

FaultySerial::FaultySerial(std::unique_ptr<bus::SerialPort> port, const Clock& clock,
                           const FaultPlan& plan, const std::shared_ptr<FaultTally>& tally)
    : port_(port.get()),
      cable_(std::make_unique<SerialAsUsb>(std::move(port)), bus::serial_pipes(), clock, plan,
             tally) {}

IoStatus FaultySerial::read(bus::SerialChunk& out) noexcept {
  do {  // a chunk that was cut to nothing is none
    const IoStatus status = cable_.read(bus::kSerialIn, packet_);
    if (status != IoStatus::Ok) return status;
  } while (packet_.size == 0);
  std::copy_n(packet_.bytes.begin(), packet_.size, out.bytes.begin());
  out.size = packet_.size;
  out.arrived_at = packet_.arrived_at;
  out.sequence = packet_.sequence;
  return IoStatus::Ok;
}

IoStatus FaultySerial::submit(std::span<const std::uint8_t> message) noexcept {
  return cable_.submit(bus::kSerialOut, message);
}

bus::SerialCounters FaultySerial::counters() const noexcept {
  bus::SerialCounters counters =
      bus::serial_counters(cable_.counters(bus::kSerialIn), cable_.counters(bus::kSerialOut));
  const bus::SerialCounters below = port_->counters();
  counters.bytes_in = below.bytes_in;
  counters.bytes_out = below.bytes_out;
  return counters;
}

}  // namespace thimble::sim
