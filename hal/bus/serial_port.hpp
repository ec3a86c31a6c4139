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

// The longest message out, and the most that is handed over at once. Ours: a packet of USB.
inline constexpr std::size_t kMaxSerialBytes = kMaxUsbPacketBytes;

// How the line is set: 8 data bits, no parity, one stop bit, no flow control. A USB device that
// only looks like a line (CDC-ACM) takes no notice of the rate.
struct SerialLine {
  std::uint32_t bit_per_s{115'200};
  bool operator==(const SerialLine&) const = default;
};

// Some bytes of the stream from the device, in its order; where one chunk ends and the next begins
// means nothing.
struct SerialChunk {
  std::array<std::uint8_t, kMaxSerialBytes> bytes{};
  std::size_t size{0};
  MonotonicTime arrived_at{};  // of its last byte, clock of the bus that delivered it
  std::uint64_t sequence{0};   // +1 for every chunk; after a gap bytes are missing

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

struct SerialCounters {
  std::uint64_t bytes_in{0};
  std::uint64_t chunks_in{0};
  std::uint64_t chunks_skipped{0};  // no room, before they were read
  std::uint64_t bytes_out{0};       // of messages_out
  std::uint64_t messages_out{0};
  std::uint64_t writes_superseded{0};  // replaced by a newer one before the bus took them
  std::uint64_t writes_failed{0};      // the bus took them, but not the device, or not all of it
  bool operator==(const SerialCounters&) const = default;
};

// An opened serial port: a stream of bytes in, whole messages out
// (docs/decisions/0325-a-serial-port-is-a-stream-in-and-messages-out.md).
//
// Input: every byte in order, until kUsbQueuedPackets chunks wait; then the newer ones are lost.
// Output: a mailbox of one message, the newest wins; but one that the bus has taken is sent to its
// end, however long the device takes, so that no message is ever cut by the next.
// There are no time-outs: whoever uses a line watches the age of what it hears.
//
// Thread: all but counters() from one thread at a time; counters() from any.
// RT: both THIMBLE_RT_IO: an exchange with the bus's mailboxes, at most one non-blocking system
//     call, never a wait, no allocation.
// Ownership: closing is the destructor's. Of what was submitted before it the newest message is
//     still sent, if the device takes it within 20 ms; a simulated bus drops it.
// Errors: IoStatus::Disconnected latches: unplugged, hung up, or closed by the machine.
class SerialPort {
 public:
  virtual ~SerialPort() = default;
  // The oldest chunk that waits; call until NoData. Ok, NoData or Disconnected.
  THIMBLE_RT_IO virtual IoStatus read(SerialChunk& out) noexcept = 0;
  // Hands a message (1 to kMaxSerialBytes) to the bus. Ok when nothing is on its way, or a message
  // reached the device whole since the last submit; else Backlogged (this one waits, and replaces
  // one that waits); Disconnected; ProtocolError when the size cannot be sent.
  THIMBLE_RT_IO virtual IoStatus submit(std::span<const std::uint8_t> message) noexcept = 0;
  [[nodiscard]] virtual SerialCounters counters() const noexcept = 0;
};

}  // namespace thimble::bus
