#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "hal/bus/serial_port.hpp"
#include "hal/bus/usb_mailboxes.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::bus {

// A serial port seen as a USB device: two bulk pipes, of which the one that brings bytes is a
// stream. For the mailboxes below and for whoever wraps one in the other.
inline constexpr std::uint8_t kSerialIn = 0x81;
inline constexpr std::uint8_t kSerialOut = 0x01;
[[nodiscard]] std::array<UsbOpenPipe, 2> serial_pipes();
[[nodiscard]] SerialCounters serial_counters(const UsbCounters& in,
                                             const UsbCounters& out) noexcept;

// The driver's end of an opened serial port, and behind it the mailboxes that a bus empties and
// fills. A bus derives from it, or owns it.
//
// Thread: SerialPort's side as there; the bus's side from one thread, which may be another;
// disconnect() from any.
// RT: all but the construction THIMBLE_RT; no system call, no allocation.
class SerialMailboxes : public SerialPort {
 public:
  SerialMailboxes();

  THIMBLE_RT_IO IoStatus read(SerialChunk& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::span<const std::uint8_t> message) noexcept override;
  // chunks_skipped is up to date after a read, writes_superseded when a message has gone out.
  [[nodiscard]] SerialCounters counters() const noexcept override;

  // Bytes arrived, at most kMaxSerialBytes; what is beyond is lost.
  THIMBLE_RT void deliver(std::span<const std::uint8_t> bytes, MonotonicTime at) noexcept;
  // What is left of the message under way, else the newest that was submitted, else empty. Valid
  // until the next sent_out().
  THIMBLE_RT std::span<const std::uint8_t> take_out() noexcept;
  // take_out() would find something; nothing is taken.
  THIMBLE_RT [[nodiscard]] bool has_out() const noexcept;
  // So many more of its bytes reached the device; with the last of them it is out.
  THIMBLE_RT void sent_out(std::size_t bytes) noexcept;
  // Something of the message under way has reached the device already.
  THIMBLE_RT [[nodiscard]] bool is_out_begun() const noexcept { return sent_ > 0; }
  THIMBLE_RT void disconnect() noexcept { pipes_.disconnect(); }
  THIMBLE_RT [[nodiscard]] bool is_disconnected() const noexcept {
    return pipes_.is_disconnected();
  }

 private:
  UsbMailboxes pipes_;
  UsbPacket packet_{};  // reader's thread
  // Bus's thread: the message under way, and how much of it is out.
  std::span<const std::uint8_t> out_{};
  std::size_t sent_{0};
  std::atomic<std::uint64_t> bytes_in_{0};
  std::atomic<std::uint64_t> bytes_out_{0};
};

}  // namespace thimble::bus
