#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/time.hpp"
#include "hal/bus/usb_mailboxes.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/fault/fault_dice.hpp"

namespace thimble::sim {

// The faults of one endpoint each, for FaultyUsb; `device` is the one below, `now` its clock's.
// Thread: as UsbDevice. RT: all THIMBLE_RT_IO, as the device below. Ownership: their dice.

// An IN pipe: what was read below and is not let through yet.
class FaultyUsbIn {
 public:
  FaultyUsbIn(bus::UsbPipe pipe, FaultDice dice) noexcept : pipe_(pipe), dice_(std::move(dice)) {}

  [[nodiscard]] std::uint8_t endpoint() const noexcept { return pipe_.endpoint; }
  THIMBLE_RT_IO IoStatus read(bus::UsbDevice& device, bus::UsbPacket& out,
                              MonotonicTime now) noexcept;
  // `counters` are those of the device below, and become those that the user sees.
  void correct(bus::UsbCounters& counters) const noexcept;

 private:
  // As many as the device below may hand over at once.
  static constexpr std::size_t kMaxUnderWay = bus::kUsbQueuedPackets;

  void take_in(bus::UsbPacket& packet) noexcept;
  [[nodiscard]] bool is_lost(const bus::UsbPacket& packet) noexcept;
  IoStatus hand_over(bus::UsbPacket& out, MonotonicTime now) noexcept;

  bus::UsbPipe pipe_;
  FaultDice dice_;
  std::array<bus::UsbPacket, kMaxUnderWay> queue_{};  // ring, oldest first, by arrived_at
  std::size_t first_{0};
  std::size_t size_{0};
  bool was_stalled_{false};
  MonotonicTime last_arrival_{Duration::min()};
  std::uint64_t lost_{0};
  std::uint64_t last_read_{0};
  // What correct() needs.
  std::atomic<std::uint64_t> not_arrived_{0};  // lost or still queued
  std::atomic<std::uint64_t> skipped_{0};
  std::atomic<std::uint64_t> halted_{0};
  std::atomic<std::uint64_t> babbled_{0};
};

// An OUT pipe: one packet that the faulty wire has taken, and the newest that waits behind it; of a
// queue one that waits, beside those that wait below.
class FaultyUsbOut {
 public:
  FaultyUsbOut(const bus::UsbOpenPipe& pipe, FaultDice dice) noexcept
      : info_(pipe.info),
        is_queued_(pipe.pipe.delivery == bus::UsbDelivery::Every),
        dice_(std::move(dice)) {}

  [[nodiscard]] std::uint8_t endpoint() const noexcept { return info_.address; }
  THIMBLE_RT_IO IoStatus submit(bus::UsbDevice& device, std::span<const std::uint8_t> bytes,
                                MonotonicTime now) noexcept;
  // Lets through whatever may pass by now; Ok, or what the device below said last.
  THIMBLE_RT_IO IoStatus serve(bus::UsbDevice& device, MonotonicTime now) noexcept;
  void correct(bus::UsbCounters& counters) const noexcept;

 private:
  struct Packet {
    std::array<std::uint8_t, bus::kMaxUsbPacketBytes> bytes{};
    std::size_t size{0};  // 0: none
    std::uint64_t number{0};
    MonotonicTime leaves_at{};
  };

  IoStatus append(bus::UsbDevice& device, std::span<const std::uint8_t> bytes,
                  MonotonicTime now) noexcept;
  void wait_with(std::span<const std::uint8_t> bytes) noexcept;
  // Packets passed on that have not ended.
  [[nodiscard]] std::uint64_t below(const bus::UsbDevice& device) const noexcept;
  [[nodiscard]] bool may_pass(const bus::UsbDevice& device) const noexcept;
  IoStatus pass(bus::UsbDevice& device, MonotonicTime now) noexcept;

  bus::UsbEndpointInfo info_;
  bool is_queued_;
  FaultDice dice_;
  Packet taken_{};
  Packet waiting_{};
  bool is_behind_late_one_{false};
  bool has_last_failed_{false};  // by a fault, and the sender is told
  std::uint64_t submitted_{0};
  std::uint64_t passed_{0};
  // What correct() needs.
  std::atomic<std::uint64_t> swallowed_{0};  // its sender thinks that it went out
  std::atomic<std::uint64_t> superseded_{0};
  std::atomic<std::uint64_t> cut_{0};
  std::atomic<std::uint64_t> halted_{0};
};

// Endpoint 0: one request at a time.
class FaultyUsbControl {
 public:
  explicit FaultyUsbControl(FaultDice dice) noexcept : dice_(std::move(dice)) {}

  THIMBLE_RT_IO IoStatus start(bus::UsbDevice& device, const bus::UsbControlRequest& request,
                               MonotonicTime now) noexcept;
  THIMBLE_RT_IO IoStatus read(bus::UsbDevice& device, bus::UsbControlReply& out,
                              MonotonicTime now) noexcept;
  THIMBLE_RT_IO IoStatus serve(bus::UsbDevice& device, MonotonicTime now) noexcept;
  void correct(bus::UsbCounters& counters) const noexcept;

 private:
  enum class State : std::uint8_t {
    Idle,
    Held,     // here, until it may leave
    Below,    // with the device
    Refused,  // by a fault: the reply is ours
    Lost,     // it never ends
  };

  [[nodiscard]] bool is_spoilt(bus::UsbControlReply& reply, MonotonicTime now) noexcept;

  FaultDice dice_;
  State state_{State::Idle};
  bus::UsbControlRequest request_{};
  MonotonicTime leaves_at_{};
  std::uint64_t started_{0};
  // What correct() needs.
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::uint64_t> babbled_{0};
  std::atomic<std::uint64_t> unanswered_{0};
};

}  // namespace thimble::sim
