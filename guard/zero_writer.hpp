#pragma once

#include <algorithm>
#include <cstdint>

#include "guard/handover.hpp"
#include "hal/linux/device_calls.hpp"
#include "hal/linux/hiddev.hpp"
#include "hal/linux/shared_device.hpp"

namespace thimble::guard {

// Lets one arm go over its node, and first over its second way where it has one: a write to hidraw
// may wait for another device, and what waits there beside it may be a force.
//
// Thread: one. write() may block as long as the kernel does: seconds for hidraw, and for hiddev
// where the arm itself takes nothing; for a bulk transfer kBulkTimeout_ms.
// Ownership: owns its copies of the descriptors; the calls must outlive it.
// Errors: counted; an arm that is gone needs no zero, and whatever else is wrong, the next try is
// all that can be done.
class ZeroWriter {
 public:
  // Ours: twenty frames of full speed, in which an arm that takes anything has taken it; then the
  // next try is made.
  static constexpr unsigned kBulkTimeout_ms = 20;

  ZeroWriter(const Handover& handover, linux::SharedDevice device,
             linux::DeviceCalls& calls) noexcept
      : handover_(handover),
        device_(std::move(device)),
        calls_(&calls),
        report_(handover.zero().last(std::max<std::size_t>(handover.size, 1) - 1)) {}

  // True: the arm's node took the whole zero, hidraw or the bulk pipe. What became of the one on
  // hiddev nobody says.
  bool write() noexcept;
  // Calls of write() that gave true, and false; calls, not zeros that reached the arm.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  bool try_once() noexcept;

  Handover handover_;
  linux::SharedDevice device_;
  linux::DeviceCalls* calls_;
  linux::HiddevReport report_;  // without the byte for the number, which is hidraw's
  std::uint64_t written_{0};
  std::uint64_t refused_{0};
};

}  // namespace thimble::guard
