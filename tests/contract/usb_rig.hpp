#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"

namespace thimble::test {

// One implementation of bus::UsbDevice together with the far end of its wire. The device has one
// interface, 0, with the endpoints below; its packets come and go within a frame of 1 ms each.
// An implementation on a real kernel waits in run_for() instead of running a virtual clock, so
// the suite asks what has happened after some frames, never when.
class UsbRig {
 public:
  static constexpr std::uint8_t kBulkIn = 0x81;         // 64 bytes, claimed with Every
  static constexpr std::uint8_t kBulkOut = 0x02;        // 64 bytes
  static constexpr std::uint8_t kInterruptIn = 0x83;    // 16 bytes each frame, claimed with Newest
  static constexpr std::uint8_t kInterruptOut = 0x04;   // 16 bytes
  static constexpr std::uint8_t kIsochronousIn = 0x85;  // of interface 1
  using Packet = std::vector<std::uint8_t>;

  virtual ~UsbRig() = default;
  virtual bus::BusEnumerator& buses() = 0;
  [[nodiscard]] virtual bus::DeviceAddress address() const = 0;
  virtual void run_for(Duration duration) = 0;

  // The device's side. Queues one packet; longer than the endpoint allows, and it babbles.
  virtual void device_sends(std::uint8_t endpoint, const Packet& packet) = 0;
  // What the device answers to requests for data from now on.
  virtual void device_answers_control(const Packet& data) = 0;
  virtual void device_stalls_once(std::uint8_t endpoint) = 0;  // 0: the next request
  // The device says Nak until it hears again.
  virtual void set_deaf(std::uint8_t endpoint, bool is_deaf) = 0;
  // All that the device took of an endpoint, oldest first.
  virtual std::vector<Packet> received_by_device(std::uint8_t endpoint) = 0;
  virtual std::vector<bus::UsbControlRequest> requests_of_device() = 0;
  virtual void unplug() = 0;
};

// How the suite makes a fresh rig for every test; no device is open in it.
struct UsbRigFactory {
  std::string name;
  std::unique_ptr<UsbRig> (*make)();
  friend void PrintTo(const UsbRigFactory& factory, std::ostream* out) { *out << factory.name; }
};

}  // namespace thimble::test
