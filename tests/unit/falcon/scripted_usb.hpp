#pragma once

#include <deque>
#include <map>
#include <span>
#include <vector>

#include "hal/bus/usb_device.hpp"
#include "tests/unit/falcon/run_packet_oracle.hpp"

namespace thimble::falcon::test {

// What a test says of a USB device and what it sees; outlives the device that a driver owns.
struct UsbScript {
  std::deque<bus::UsbPacket> arrived;
  std::vector<Bytes> submitted;
  std::vector<bus::UsbControlRequest> requests;
  std::deque<bus::UsbOutcome> request_ends;
  bool is_connected{true};
  bool ends_requests{true};
  MonotonicTime now{std::chrono::seconds(100)};
  std::uint64_t sequence{0};

  // A packet of the bridge with these bytes behind its modem status.
  void arrive(const Bytes& serial, Duration after = std::chrono::milliseconds(1)) {
    bus::UsbPacket packet;
    packet.bytes[0] = 0x01;
    packet.bytes[1] = 0x60;
    std::copy(serial.begin(), serial.end(), packet.bytes.begin() + 2);
    packet.size = serial.size() + 2;
    now = now + after;
    packet.arrived_at = now;
    packet.sequence = ++sequence;
    arrived.push_back(packet);
  }
};

// A USB device that does what its script says; requests succeed at once, or never end.
class ScriptedUsb final : public bus::UsbDevice {
 public:
  explicit ScriptedUsb(UsbScript& script) : script_(script) {}
  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    if (endpoint != 0x81) return IoStatus::ProtocolError;
    if (script_.arrived.empty()) return IoStatus::NoData;
    out = script_.arrived.front();
    script_.arrived.pop_front();
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    if (endpoint != 0x02 || packet.empty() || packet.size() > 64) return IoStatus::ProtocolError;
    script_.submitted.emplace_back(packet.begin(), packet.end());
    return IoStatus::Ok;
  }
  IoStatus start_control(const bus::UsbControlRequest& request) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    script_.requests.push_back(request);
    if (script_.ends_requests) script_.request_ends.push_back(bus::UsbOutcome::Done);
    return IoStatus::Ok;
  }
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    if (!script_.is_connected) return IoStatus::Disconnected;
    if (script_.request_ends.empty()) return IoStatus::NoData;
    out = {};
    out.outcome = script_.request_ends.front();
    script_.request_ends.pop_front();
    return IoStatus::Ok;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t endpoint) const noexcept override {
    bus::UsbCounters counters;
    if (endpoint == 0x02) counters.packets_out = script_.submitted.size();
    return counters;
  }

 private:
  UsbScript& script_;
};

}  // namespace thimble::falcon::test
