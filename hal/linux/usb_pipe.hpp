#pragma once

#include <libusb.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/linux/usb_transfers.hpp"

namespace thimble::linux {

// A transfer of libusb, with its buffers. Thread, RT, ownership: as UsbTransfers.
class UsbTransfers::Transfer {
 public:
  // `pipe` is nullptr for endpoint 0.
  Transfer(UsbTransfers& owner, Pipe* pipe, std::size_t bytes)
      : owner_(&owner),
        pipe_(pipe),
        raw_(::libusb_alloc_transfer(0)),
        buffer_(bytes),
        spare_(bytes) {}
  ~Transfer() { ::libusb_free_transfer(raw_); }
  Transfer(const Transfer&) = delete;
  Transfer& operator=(const Transfer&) = delete;

  // Not before the device is open: it remembers its handle. False without memory.
  [[nodiscard]] bool prepare(const bus::UsbEndpointInfo* info) noexcept {
    if (raw_ == nullptr) return false;
    raw_->dev_handle = owner_->handle_;
    raw_->endpoint = info == nullptr ? 0 : info->address;
    raw_->type = type_of(info == nullptr ? bus::UsbTransferKind::Control : info->kind);
    raw_->timeout = 0;
    raw_->callback = [](libusb_transfer* raw) {
      auto* transfer = static_cast<Transfer*>(raw->user_data);
      transfer->owner_->ended(*transfer);
    };
    raw_->user_data = this;
    raw_->length = static_cast<int>(buffer_.size());
    return true;
  }
  [[nodiscard]] libusb_transfer& raw() noexcept { return *raw_; }
  [[nodiscard]] Pipe* pipe() noexcept { return pipe_; }
  [[nodiscard]] std::vector<std::uint8_t>& buffer() noexcept { return buffer_; }
  // The other buffer goes to the kernel next; returns the one that has just been filled.
  std::span<const std::uint8_t> swap_buffers() noexcept {
    buffer_.swap(spare_);
    return {spare_.data(), static_cast<std::size_t>(std::max(raw_->actual_length, 0))};
  }
  bool is_under_way{false};

 private:
  // libusb's numbers are those of the descriptors.
  static std::uint8_t type_of(bus::UsbTransferKind kind) noexcept {
    return static_cast<std::uint8_t>(kind);
  }

  UsbTransfers* owner_;
  Pipe* pipe_;
  libusb_transfer* raw_;
  std::vector<std::uint8_t> buffer_;
  std::vector<std::uint8_t> spare_;
};

// An endpoint's transfers. Thread, RT, ownership: as UsbTransfers.
struct UsbTransfers::Pipe {
  // libusb cuts what is longer into pieces, each a call into the kernel (MAX_BULK_BUFFER_LENGTH).
  static constexpr std::size_t kMostRunBytes = 16384;

  std::size_t index{0};  // in the mailboxes
  bus::UsbEndpointInfo info;
  std::vector<std::unique_ptr<Transfer>> transfers;
  bool is_halted{false};
  MonotonicTime not_before{Duration::min()};  // the next try after a failure

  MonotonicTime counted_from{Duration::min()};
  std::size_t counted{0};

  // How many reads have ended in this stretch of time, with this one.
  std::size_t count_read(MonotonicTime now, Duration stretch) noexcept {
    if (now >= counted_from + stretch) {
      counted_from = now;
      counted = 0;
    }
    return ++counted;
  }
  // Of one transfer.
  [[nodiscard]] std::size_t most_packets(const bus::UsbMailboxes& mail) const noexcept {
    if (!mail.is_queued_out(index)) return 1;
    return std::min<std::size_t>(bus::kUsbQueuedPackets, kMostRunBytes / info.max_packet_bytes);
  }
  [[nodiscard]] bool is_idle() const noexcept {
    return std::none_of(transfers.begin(), transfers.end(),
                        [](const auto& transfer) { return transfer->is_under_way; });
  }
};

}  // namespace thimble::linux
