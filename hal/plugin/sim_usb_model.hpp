#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/arm_backend.hpp"

namespace thimble::plugin {

class ModelPanel;  // sim_model.hpp

// What a device answers to one transaction, USB 2.0, 8.4.5.
enum class UsbHandshake : std::uint8_t {
  Ack,
  Nak,    // not now: the bus asks again
  Stall,  // refused; the bus clears the halt, so the next transaction finds the endpoint working
};

struct UsbAnswer {
  UsbHandshake handshake{UsbHandshake::Nak};
  std::size_t size{0};  // bytes that the device sends; more than it was given room for: it babbles
};

// Bus face of a simulated USB device at full speed: what its interface and what is behind it do.
// The bus calls, in virtual time and from one thread, advance(t) in every eighth of a frame, and
// then, while somebody has it open: control() if a request waits, out_packet() for each packet that
// waits, in_packet() for each pipe that is claimed; see sim/bus/sim_usb_port.hpp.
//
// Thread: that of the bus. RT: everything but describe(): bounded, no allocation.
// Ownership: of the bus. Errors: what a device can say; bytes come from a driver and may be any.
class SimUsbModel {
 public:
  virtual ~SimUsbModel() = default;
  // Ids, names and endpoints; address and kind are the bus's.
  [[nodiscard]] virtual bus::BusDeviceInfo describe() const = 0;
  // Brings mechanics and firmware to `t` (never backwards).
  virtual void advance(MonotonicTime t) noexcept = 0;
  // A vendor's or class request. Host to device: its bytes are in `request`. Device to host: fills
  // `in`, which has room for request.length bytes. Asked again as long as the answer is Nak.
  virtual UsbAnswer control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept = 0;
  // `bytes` is one packet, also an empty one, no longer than the endpoint's.
  virtual UsbHandshake out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept = 0;
  // Fills `out`, which has room for one packet of the endpoint. Ack with size 0: an empty packet.
  virtual UsbAnswer in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept = 0;
  // From when on it may have something for the host, or refuse what it is asked on an endpoint that
  // it has, if it is sent nothing more: in rounds before that a bus need not advance it and ask. In
  // the past: it has something already, or nobody knows.
  [[nodiscard]] virtual MonotonicTime unchanged_until() const noexcept { return {}; }
  // Power cut and restored, as on unplug and replug: what is in volatile memory is lost.
  virtual void power_cycle() noexcept = 0;
  [[nodiscard]] virtual ArmBackend* arm_backend() noexcept = 0;  // nullptr: not an arm
  [[nodiscard]] virtual ModelPanel* panel() noexcept { return nullptr; }
};

}  // namespace thimble::plugin
