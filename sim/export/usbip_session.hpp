#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <vector>

#include "hal/plugin/sim_usb_model.hpp"
#include "sim/export/plug.hpp"
#include "sim/export/usb_descriptors.hpp"
#include "sim/export/usbip_wire.hpp"

namespace thimble::sim {

// One connection of a host that speaks USB/IP to one simulated device: the bytes of both sides, and
// the bus between them. It knows no socket: what came is given to take(), what is to go is in
// outbox().
//
// Every transfer waits for a round of the bus (serve()), in order for each endpoint, and is
// answered there: as it is taken or given by the model, with -EPIPE for a STALL, -EOVERFLOW for
// babble, -EREMOTEIO for less than the host insisted on; NAK leaves it waiting. After a STALL of
// the model's what waits for the endpoint waits on, as with a host controller, until the host ends
// the halt; the misbehaviour's stall fails each transfer and halts nothing (decision 0377). A
// transfer that is unlinked is answered by that alone, with -ECONNRESET; one that had ended before
// with 0: each unlink has one answer.
//
// Bounded: a transfer has at most kMaxTransferBytes, and kMaxTransfers wait; who asks for more, or
// says what is no message, has to be cut off, and so has one that asks for more while
// kMaxOutboxBytes are in outbox(): take() says so. serve() still answers what waits. Who has the
// socket has to cut off a host that takes nothing (UsbipBus::kPatience).
// Thread: one. RT: no. Ownership: model, log and misbehaviour must outlive it.
// Errors: take() says so.
class UsbipSession {
 public:
  // All ours. 43 frames of the wire; our drivers ask for packets of 64 bytes.
  static constexpr std::size_t kMaxTransferBytes = 65536;
  // A driver of ours has two pending on each pipe.
  static constexpr std::size_t kMaxTransfers = 256;
  // 64 of the longest transfers.
  static constexpr std::size_t kMaxOutboxBytes = 4U << 20U;
  static constexpr const char* kBusId = "1-1";
  static constexpr std::uint32_t kDeviceId = 1U << 16U | 1U;  // bus 1, device 1, as it is listed

  // Full speed has 1500 bytes in a frame of 1 ms: they are divided among its rounds.
  UsbipSession(plugin::SimUsbModel& model, const UsbPersona& persona, unsigned rounds_per_frame,
               const PlugSurroundings& surroundings);

  // Whether a host may attach the device now, and sees it listed; it may not at first.
  void set_available(bool is_available) noexcept { is_available_ = is_available; }
  // In place of its request: the host has the device from now on, whoever gave it to it.
  void attach() noexcept { is_attached_ = true; }
  // False: the connection has to end.
  [[nodiscard]] bool take(std::span<const std::uint8_t> bytes);
  void serve(MonotonicTime now);
  // In place of serve(), for a round in which nothing is to happen.
  void leave_round_out() noexcept { ++round_; }
  // The next round in which something happens even if the host says nothing: at most a frame after
  // `now`, that of the last one.
  [[nodiscard]] MonotonicTime next_needed(MonotonicTime now) const noexcept;
  [[nodiscard]] std::vector<std::uint8_t>& outbox() noexcept { return outbox_; }

  [[nodiscard]] bool is_attached() const noexcept { return is_attached_; }
  // It had a list, or was refused the device: whoever wants more of it connects again, as with the
  // usbipd of a kernel.
  [[nodiscard]] bool is_over() const noexcept { return is_answered_ && !is_attached_; }
  // Somebody on the host's side has a transfer on one of its endpoints, or had within the last
  // kUseLasts. Ours: a driver that polls has a transfer pending nearly always, and tells nobody
  // when it closes.
  static constexpr Duration kUseLasts = std::chrono::milliseconds(100);
  [[nodiscard]] bool is_used(MonotonicTime now) const noexcept {
    return used_at_ && now - *used_at_ < kUseLasts;
  }
  [[nodiscard]] std::size_t waiting() const noexcept { return transfers_.size(); }
  [[nodiscard]] const PlugCounters& counters() const noexcept { return counters_; }

 private:
  struct Transfer {
    usbip::Submit submit;
    std::vector<std::uint8_t> data;  // that goes out
    std::vector<std::uint8_t> in;    // that came
    std::size_t done{0};             // of data
  };
  // What a look at a transfer led to.
  enum class Progress : std::uint8_t { Waits, Ended };

  [[nodiscard]] std::size_t message_bytes() const;  // of the first one in inbox_; 0: unknown yet
  [[nodiscard]] bool take_message(std::span<const std::uint8_t> message);
  [[nodiscard]] bool take_op(std::span<const std::uint8_t> message);
  [[nodiscard]] bool take_submit(const usbip::Submit& submit, std::span<const std::uint8_t> data);
  [[nodiscard]] bool waits_for_model(const Transfer& transfer) const noexcept;
  void take_unlink(const usbip::Unlink& unlink);
  [[nodiscard]] usbip::DeviceRecord record() const;

  void serve_kind(bus::UsbTransferKind kind, MonotonicTime now);
  [[nodiscard]] const bus::UsbEndpointInfo* endpoint_of(const Transfer& transfer) const noexcept;
  [[nodiscard]] bool is_due(const bus::UsbEndpointInfo& endpoint) const noexcept;
  Progress control(Transfer& transfer, MonotonicTime now);
  Progress class_request(Transfer& transfer, const bus::UsbControlRequest& request,
                         MonotonicTime now);
  Progress send(Transfer& transfer, const bus::UsbEndpointInfo& endpoint, MonotonicTime now);
  Progress fetch(Transfer& transfer, const bus::UsbEndpointInfo& endpoint, MonotonicTime now);
  Progress end(const Transfer& transfer, std::int32_t status);
  Progress halt(const Transfer& transfer, const bus::UsbEndpointInfo& endpoint);
  [[nodiscard]] bool is_halted(const bus::UsbEndpointInfo& endpoint) const noexcept;
  Progress put_off() noexcept;
  bool take_budget(std::size_t bytes) noexcept;

  plugin::SimUsbModel* model_;
  const UsbPersona* persona_;
  PlugSurroundings around_;
  unsigned rounds_per_frame_;
  std::uint64_t round_{0};
  std::size_t bytes_left_{0};
  // The next round matters by what happened in this one, or did not for want of time, or by what
  // was asked since.
  bool is_under_way_{false};
  bool is_available_{false};
  bool is_attached_{false};
  bool is_answered_{false};  // of what is asked before it attaches
  std::uint8_t configuration_{0};
  std::vector<bus::UsbEndpointInfo> halted_;
  std::optional<MonotonicTime> used_at_;
  std::vector<std::uint8_t> inbox_;
  std::vector<std::uint8_t> outbox_;
  std::list<Transfer> transfers_;  // as they came
  PlugCounters counters_{};
};

}  // namespace thimble::sim
