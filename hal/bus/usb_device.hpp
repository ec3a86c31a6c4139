#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/usb_descriptor.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::bus {

// One packet of a bulk or interrupt endpoint. It may be empty, and it may be shorter than the
// endpoint's packets can be: that ends nothing.
struct UsbPacket {
  std::array<std::uint8_t, kMaxUsbPacketBytes> bytes{};
  std::size_t size{0};
  MonotonicTime arrived_at{};  // clock of the bus that delivered it
  std::uint64_t sequence{0};   // +1 for every packet of its endpoint that arrived, read or not

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

// Ours: no request of a known arm has a data stage of more than a few bytes.
inline constexpr std::size_t kMaxUsbControlBytes = 64;
// USB 2.0, table 9-2: bits 5 and 6 of bmRequestType, who defined the request.
inline constexpr std::uint8_t kUsbRequestOwnerBits = 0x60;

// A request to endpoint 0. Field names without their Hungarian prefixes as in USB 2.0, 9.3.
struct UsbControlRequest {
  std::uint8_t request_type{0x40};  // 0x40: vendor's, host to device; 0xc0: device to host
  std::uint8_t request{0};
  std::uint16_t value{0};
  std::uint16_t index{0};
  std::uint16_t length{0};  // of the data stage: bytes that are sent, or wanted
  std::array<std::uint8_t, kMaxUsbControlBytes> data{};  // host to device
  bool operator==(const UsbControlRequest&) const = default;
};

// False for what is too long, and for a standard request.
[[nodiscard]] constexpr bool may_be_sent(const UsbControlRequest& request) noexcept {
  return request.length <= kMaxUsbControlBytes &&
         (request.request_type & kUsbRequestOwnerBits) != 0;
}
// USB 2.0, table 9-2: bit 7 of bmRequestType is the direction of the data stage.
[[nodiscard]] constexpr bool asks_for_data(const UsbControlRequest& request) noexcept {
  return (request.request_type & kUsbInBit) != 0;
}

// How a transfer ended that did not end by the cable.
enum class UsbOutcome : std::uint8_t {
  Done,
  Stalled,  // the device refused it (STALL handshake)
  Babbled,  // the device sent more than was asked for: nothing of it is kept
  Failed,   // spoilt on the wire beyond the host controller's retries
};

struct UsbControlReply {
  UsbOutcome outcome{UsbOutcome::Done};
  std::array<std::uint8_t, kMaxUsbControlBytes> data{};  // device to host
  std::size_t size{0};                                   // of `data`; for output, bytes taken
};

// Of one endpoint. What went out is counted when the device has taken it.
struct UsbCounters {
  std::uint64_t packets_in{0};
  std::uint64_t packets_skipped{0};  // arrived but superseded, or no room, before they were read
  std::uint64_t packets_out{0};
  std::uint64_t writes_superseded{0};  // replaced by a newer one before the bus took them
  std::uint64_t writes_cut{0};         // of packets_out: the device took only their beginning
  std::uint64_t stalls{0};             // a transfer ended Stalled; so the next three
  std::uint64_t babbles{0};
  std::uint64_t failures{0};
  bool operator==(const UsbCounters&) const = default;
};

// Packets that an UsbDelivery::Every endpoint keeps: in, for a reader who is late, 64 ms of a
// device that sends one per frame; when they are full the newer ones are lost and counted. Out,
// until the device takes them. Ours.
inline constexpr std::size_t kUsbQueuedPackets = 64;

// An opened USB device: one claimed interface, its pipes, and endpoint 0.
//
// Input: from the opening on the bus always has a transfer pending on every IN pipe, and after
// each it asks again first and delivers then. Output: a mailbox of one packet per OUT pipe, the
// newest wins, or with UsbDelivery::Every a queue; but a packet that the bus has taken is offered
// to the device until it is taken. So who waits for the device's answer before the next submit()
// loses none.
// There are no time-outs: a device that answers nothing is silent for ever, and whoever uses it
// watches the age of what it hears. After a stall the bus clears the halt by itself, that of an IN
// pipe perhaps some 50 ms later; a transfer that ended badly is counted, never repeated.
//
// Thread: all but counters() from one thread at a time (any non-RT one while the driver
// opens, then the servo); counters() from any.
// RT: all THIMBLE_RT_IO: an exchange with the bus's mailboxes, at most one non-blocking system
//     call (a wake-up of the bus's thread), never a wait, no allocation.
// Ownership: closing is the destructor's. Of what was submitted before it the newest packet of each
//     OUT pipe, or of its queue the next ones, is still sent, if the device takes it within 20 ms;
//     a simulated bus, on which no time passes meanwhile, drops it. Then what is pending is
//     cancelled, and the device ends silent. The enumerator must outlive it.
// Errors: IoStatus::Disconnected latches; unplugging shows here, whatever the enumerator says and
//     when. What arrived before it and was not read is lost.
class UsbDevice {
 public:
  virtual ~UsbDevice() = default;
  // The next packet of an IN pipe: the newest since the last call, or with UsbDelivery::Every the
  // oldest that waits (call until NoData). Ok, NoData or Disconnected; ProtocolError when
  // `endpoint` is no IN pipe of this claim.
  THIMBLE_RT_IO virtual IoStatus read(std::uint8_t endpoint, UsbPacket& out) noexcept = 0;
  // Hands a packet to an OUT pipe. Ok when nothing is on its way, or a packet reached the device
  // whole since the last submit; else Backlogged, be the last one still on its way or failed (this
  // one waits, and replaces one that waits), so that a pipe on which everything fails is Ok once
  // only; Disconnected; ProtocolError when it is empty, longer than the endpoint's packets, or
  // `endpoint` is no OUT pipe of this claim. With UsbDelivery::Every: Ok, it is sent behind those
  // before; Backlogged, kUsbQueuedPackets wait and it is not taken. One that ends badly is left out
  // and counted, the next ones follow.
  THIMBLE_RT_IO virtual IoStatus submit(std::uint8_t endpoint,
                                        std::span<const std::uint8_t> packet) noexcept = 0;
  // Sends a request to endpoint 0; its end comes by read_control(). One at a time: Backlogged, and
  // nothing sent, until the end of the last one has been read. Ok or Disconnected; ProtocolError
  // when it is too long, or a standard request: those belong to the bus.
  THIMBLE_RT_IO virtual IoStatus start_control(const UsbControlRequest& request) noexcept = 0;
  // Ok once for every request that ended, however it did; NoData before; Disconnected.
  THIMBLE_RT_IO virtual IoStatus read_control(UsbControlReply& out) noexcept = 0;
  // Of a pipe of this claim; of endpoint 0, where a request counts as a packet out; else zeros.
  // packets_skipped is up to date after a read, writes_superseded when a packet has gone out.
  [[nodiscard]] virtual UsbCounters counters(std::uint8_t endpoint) const noexcept = 0;
};

}  // namespace thimble::bus
