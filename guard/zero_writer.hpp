#pragma once

#include <cstdint>
#include <utility>

#include "guard/handover.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/device_calls.hpp"
#include "hal/linux/hiddev.hpp"

namespace thimble::guard {

// Lets one arm go over its node: the way by which the daemon drives it, so that what that has on
// its way leaves before this.
//
// Thread: one. write() may block as long as the kernel does: seconds for hidraw, where another
// device may hold it up, and for hiddev where the arm itself takes nothing; for a bulk transfer
// kBulkTimeout_ms.
// Ownership: owns its copies of the descriptors; the calls must outlive it.
// Errors: counted; whatever is wrong but that the arm is gone, the next try is all that can be
// done.
class ZeroWriter {
 public:
  // Ours: twenty frames of full speed, in which an arm that takes anything has taken it; then the
  // next try is made.
  static constexpr unsigned kBulkTimeout_ms = 20;

  ZeroWriter(const Handover& handover, linux::Descriptor node, linux::DeviceCalls& calls) noexcept
      : handover_(handover), node_(std::move(node)), calls_(&calls), hiddev_(node_.get(), calls) {}

  // True: the arm's node took the whole zero. What became of one over hiddev nobody says: an arm
  // that refuses it is let go by its own watchdog, which such an arm must have (decision 0358).
  bool write() noexcept;
  // After a write that was refused: the arm left its node, and no other will be taken.
  [[nodiscard]] bool is_gone() noexcept;
  // Calls of write() that gave true, and false; calls, not zeros that reached the arm.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  bool try_once() noexcept;

  Handover handover_;
  linux::Descriptor node_;
  linux::DeviceCalls* calls_;
  linux::HiddevOutput hiddev_;  // for ZeroRoute::Hiddev
  int refused_by_{0};           // errno of the last refusal; 0: a part was taken
  std::uint64_t written_{0};
  std::uint64_t refused_{0};
};

}  // namespace thimble::guard
