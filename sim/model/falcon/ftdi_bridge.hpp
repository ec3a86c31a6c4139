#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/usb_device.hpp"
#include "hal/plugin/sim_usb_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/falcon/serial_line.hpp"

namespace thimble::sim {

// Its speed in baud: 3 MHz by a divisor of 14 bits and eighths, whose code is bits 14 to 16
// (bit 16 travels in bit 0 of wIndex). 0 and 1 are special: 3 and 2 MHz.
// Sources: FT232R data sheet ("baud rates"); the code's order: Linux drivers/usb/serial/ftdi_sio.h.
THIMBLE_RT [[nodiscard]] double ftdi_baud(std::uint32_t divisor) noexcept;

struct FtdiCounters {
  std::uint64_t bytes_from_host{0};
  std::uint64_t bytes_to_host{0};
  std::uint64_t data_packets{0};         // with at least one byte of data
  std::uint64_t status_packets{0};       // of the two bytes of status alone
  std::uint64_t framing_errors{0};       // of bytes that came in at another speed
  std::uint64_t overruns{0};             // bytes that came in when there was no room: lost
  std::uint64_t host_packets_nak{0};     // host's packets put off as there was no room
  std::uint64_t refused_requests{0};     // unknown: answered by STALL
  std::uint64_t unmodelled_requests{0};  // taken and without effect here: flow control, characters
  bool operator==(const FtdiCounters&) const = default;
};

// FT232R: a USB device on one side, a UART and two modem lines on the other.
//
// To the host it sends packets of up to 64 bytes, of which the first two are always status. One
// goes when 62 bytes of data wait, or when the latency timer has run out since the last one: then
// with what there is, and with nothing but the status when there is nothing. Else it says NAK. The
// timer is 1 to 255 ms, 16 after power-up. Sources: FT232R data sheet ("receive buffer timeout"),
// ftdi_sio.h (status bytes, requests), libftdi 1.5 (which purge is which). The timer begins anew
// with each packet (FTDI AN232B-04), on the bus's clock: ours.
//
// Thread: one. RT: all. Errors: none; requests may be any, and those it does not know stall.
class FtdiBridge {
 public:
  // FT232R data sheet: 128 bytes from the host to the line, 256 from the line to the host.
  static constexpr std::size_t kFromHostBytes = 128;
  static constexpr std::size_t kToHostBytes = 256;
  static constexpr std::size_t kStatusBytes = 2;
  static constexpr std::size_t kPacketBytes = 64;

  THIMBLE_RT void power_up(MonotonicTime t) noexcept;

  // USB side, as SimUsbModel, at bus time `t`.
  THIMBLE_RT plugin::UsbAnswer control(MonotonicTime t, const bus::UsbControlRequest& request,
                                       std::span<std::uint8_t> in) noexcept;
  THIMBLE_RT plugin::UsbHandshake out_packet(MonotonicTime t,
                                             std::span<const std::uint8_t> bytes) noexcept;
  THIMBLE_RT plugin::UsbAnswer in_packet(MonotonicTime t, std::span<std::uint8_t> out) noexcept;

  // From when on it has a packet for the host, if no more than `more` bytes come in; in the past:
  // it has one, or would have one as soon as all of them are in.
  [[nodiscard]] MonotonicTime next_packet_at(std::size_t more) const noexcept {
    return count_ + more < kPacketBytes - kStatusBytes ? packet_due_at_ : MonotonicTime{};
  }
  // To the far end of its line.
  [[nodiscard]] std::size_t under_way() const noexcept { return sender_.under_way(); }

  // Serial side. What the host wrote arrives at its far end then and there.
  [[nodiscard]] MonotonicTime next_arrival() const noexcept { return sender_.next_arrival(); }
  THIMBLE_RT SerialByte take_arrived() noexcept;
  THIMBLE_RT void receive(SerialByte byte) noexcept;
  [[nodiscard]] bool is_dtr_high() const noexcept { return is_dtr_high_; }
  [[nodiscard]] bool is_rts_high() const noexcept { return is_rts_high_; }

  [[nodiscard]] double speed_baud() const noexcept { return sender_.speed_baud(); }
  [[nodiscard]] Duration latency() const noexcept { return insisted_.value_or(latency_); }
  // On demand: it has this latency, whatever it is told, also after a loss of power; nothing: what
  // it was told last.
  void insist_on_latency(std::optional<Duration> latency) noexcept { insisted_ = latency; }
  [[nodiscard]] std::optional<Duration> insisted_latency() const noexcept { return insisted_; }
  [[nodiscard]] const FtdiCounters& counters() const noexcept { return counters_; }

 private:
  THIMBLE_RT bool set(MonotonicTime t, const bus::UsbControlRequest& request) noexcept;
  THIMBLE_RT void reset(std::uint16_t what) noexcept;
  THIMBLE_RT void set_modem_lines(std::uint16_t value) noexcept;
  [[nodiscard]] std::array<std::uint8_t, kStatusBytes> status() const noexcept;

  SerialSender<kFromHostBytes> sender_;
  std::array<std::uint8_t, kToHostBytes> to_host_{};
  std::size_t first_{0};
  std::size_t count_{0};
  Duration latency_{std::chrono::milliseconds(16)};
  std::optional<Duration> insisted_;
  MonotonicTime packet_due_at_{};
  bool is_dtr_high_{false};
  bool is_rts_high_{false};
  bool is_8n1_{true};
  bool has_overrun_{false};  // since the last packet: told in its status
  bool has_framing_error_{false};
  FtdiCounters counters_{};
};

}  // namespace thimble::sim
