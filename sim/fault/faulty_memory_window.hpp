#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/memory_window.hpp"
#include "sim/fault/fault_dice.hpp"
#include "sim/fault/fault_plan.hpp"

namespace thimble::sim {

// Any memory window behind a bad slot: passes everything on, but for what the plan says.
//
// A read is a report in, a write a report out, a block is one; those that the window refuses do not
// count. DropIn reads all ones, DropOut is lost; CorruptIn and CorruptOut have another byte;
// of what TruncateIn and TruncateOut cut only the first words pass, and the rest of a read is all
// ones. Stall: the board does not answer, all reads are ones and all writes lost. Disconnect
// latches. Other kinds mean nothing here: a bus in order keeps nothing back.
//
// Thread, RT: as MemoryWindow. Ownership: owns the window below. The clock must outlive it.
// Errors: as the window below.
class FaultyMemoryWindow final : public bus::MemoryWindow {
 public:
  FaultyMemoryWindow(std::unique_ptr<bus::MemoryWindow> window, const Clock& clock,
                     const FaultPlan& plan,
                     const std::shared_ptr<FaultTally>& tally = std::make_shared<FaultTally>());

  [[nodiscard]] std::size_t bytes() const noexcept override { return window_->bytes(); }
  IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept override;
  IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept override;
  IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept override;
  IoStatus write_block(std::uint32_t offset,
                       std::span<const std::uint32_t> words) noexcept override;
  void barrier() noexcept override { window_->barrier(); }
  [[nodiscard]] FaultCounts injected() const noexcept { return dice_.tally().read(); }

 private:
  [[nodiscard]] bool is_gone(MonotonicTime now) noexcept;
  [[nodiscard]] bool is_stalled(MonotonicTime now) noexcept;

  std::unique_ptr<bus::MemoryWindow> window_;
  const Clock* clock_;
  FaultDice dice_;
  bool is_gone_{false};
  MonotonicTime stalled_until_{Duration::min()};
  std::uint64_t reads_{0};
  std::uint64_t writes_{0};
  std::vector<std::uint32_t> damaged_;
};

}  // namespace thimble::sim
