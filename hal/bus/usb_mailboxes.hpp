#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/bus/usb_device.hpp"
#include "hal/rt/annotations.hpp"
#include "hal/rt/spsc_ring.hpp"
#include "hal/rt/triple_buffer.hpp"

namespace thimble::bus {

// One endpoint of a claim together with what the descriptors say of it.
struct UsbOpenPipe {
  UsbPipe pipe;
  UsbEndpointInfo info;
};

// Looks a claim up in a device's descriptors, in the order of the claim. InvalidArgument for an
// endpoint that its interface lacks, that is named twice, that is neither bulk nor interrupt, or
// whose packets are empty or longer than kMaxUsbPacketBytes.
[[nodiscard]] Result<std::vector<UsbOpenPipe>> resolve_claim(
    const UsbClaim& claim, std::span<const UsbEndpointInfo> endpoints);

// The driver's end of an opened USB device, and behind it the mailboxes that a bus empties and
// fills: what every implementation of UsbDevice has in common. A bus derives from it, or owns it.
//
// Thread: UsbDevice's side as there; the bus's side from one thread, which may be another;
// disconnect() from any.
// RT: all but the construction THIMBLE_RT; no system call, no allocation.
// Ownership: owns the mailboxes. Errors: as UsbDevice.
class UsbMailboxes : public UsbDevice {
 public:
  explicit UsbMailboxes(std::span<const UsbOpenPipe> pipes);
  ~UsbMailboxes() override;
  UsbMailboxes(const UsbMailboxes&) = delete;
  UsbMailboxes& operator=(const UsbMailboxes&) = delete;

  THIMBLE_RT_IO IoStatus read(std::uint8_t endpoint, UsbPacket& out) noexcept override;
  THIMBLE_RT_IO IoStatus submit(std::uint8_t endpoint,
                                std::span<const std::uint8_t> packet) noexcept override;
  THIMBLE_RT_IO IoStatus start_control(const UsbControlRequest& request) noexcept override;
  THIMBLE_RT_IO IoStatus read_control(UsbControlReply& out) noexcept override;
  [[nodiscard]] UsbCounters counters(std::uint8_t endpoint) const noexcept override;

  // The bus's side. `pipe` is an index into what the constructor was given.
  [[nodiscard]] std::size_t pipe_count() const noexcept { return pipes_.size(); }
  [[nodiscard]] const UsbEndpointInfo& info(std::size_t pipe) const noexcept;
  // Output that is a stream: more may wait behind a packet that has ended.
  [[nodiscard]] bool is_queued_out(std::size_t pipe) const noexcept;
  // The packet to offer to the device: the one whose end is still owed, else the newest that was
  // submitted (of a queue: the oldest), else empty. Of a queue several can be offered at once: the
  // one that comes behind `nth` others. Valid until its finish_out().
  THIMBLE_RT std::span<const std::uint8_t> take_out(std::size_t pipe, std::size_t nth = 0) noexcept;
  // take_out() would find something. Nothing is taken: a newer packet may still come before it.
  THIMBLE_RT [[nodiscard]] bool has_out(std::size_t pipe) const noexcept;
  // How a packet ended that take_out() returned, of several the oldest; `taken` of its bytes
  // reached the device.
  THIMBLE_RT void finish_out(std::size_t pipe, UsbOutcome outcome, std::size_t taken) noexcept;
  // A transfer of an IN pipe ended; `packet` counts when it is Done. False: nobody reads, and it
  // found no room.
  THIMBLE_RT bool finish_in(std::size_t pipe, UsbOutcome outcome,
                            std::span<const std::uint8_t> packet, MonotonicTime at) noexcept;
  // The request whose end is owed, or nullptr. Valid until finish_control().
  THIMBLE_RT const UsbControlRequest* take_control() noexcept;
  THIMBLE_RT void finish_control(const UsbControlReply& reply) noexcept;
  // From now on every call of the driver's side says so.
  THIMBLE_RT void disconnect() noexcept { is_gone_.store(true, std::memory_order_release); }
  THIMBLE_RT [[nodiscard]] bool is_disconnected() const noexcept {
    return is_gone_.load(std::memory_order_acquire);
  }

 private:
  // How many transfers of one endpoint ended in each way.
  class Endings {
   public:
    THIMBLE_RT void add(UsbOutcome outcome) noexcept;
    void write_to(UsbCounters& counters) const noexcept;
    [[nodiscard]] std::uint64_t done() const noexcept {
      return done_.load(std::memory_order_relaxed);
    }

   private:
    std::atomic<std::uint64_t> done_{0};
    std::atomic<std::uint64_t> stalled_{0};
    std::atomic<std::uint64_t> babbled_{0};
    std::atomic<std::uint64_t> failed_{0};
  };
  class Pipe;
  class InPipe;
  class OutPipe;
  [[nodiscard]] Pipe* find(std::uint8_t endpoint) const noexcept;

  std::vector<std::unique_ptr<Pipe>> pipes_;
  std::atomic<bool> is_gone_{false};
  rt::TripleBuffer<UsbControlRequest> requests_;
  rt::TripleBuffer<UsbControlReply> replies_;
  // Driver's thread.
  bool is_reply_owed_{false};
  // Bus's thread.
  UsbControlRequest request_{};
  bool is_request_open_{false};
  Endings control_endings_;
};

}  // namespace thimble::bus
