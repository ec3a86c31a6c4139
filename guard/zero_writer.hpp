#pragma once

#include <cstdint>

#include "guard/handover.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::guard {

// Lets one arm go over its node.
//
// Thread: one. write() may block as long as the kernel does: seconds for hidraw; for a bulk
// transfer kBulkTimeout_ms. Ownership: owns its copy of the node's descriptor.
// Errors: counted; an arm that is gone needs no zero, and whatever else is wrong, the next try is
// all that can be done.
class ZeroWriter {
 public:
  static constexpr unsigned kBulkTimeout_ms = 20;

  ZeroWriter(const Handover& handover, linux::Descriptor node) noexcept
      : handover_(handover), node_(std::move(node)) {}

  bool write() noexcept;
  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  bool try_once() noexcept;

  Handover handover_;
  linux::Descriptor node_;
  std::uint64_t written_{0};
  std::uint64_t refused_{0};
};

}  // namespace thimble::guard
