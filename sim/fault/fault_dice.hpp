#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/fault/fault_plan.hpp"

namespace thimble::sim {

// How many faults of each kind were injected.
struct FaultCounts {
  std::array<std::uint64_t, kFaultKindCount> by_kind{};
  std::uint64_t out_under_way{0};  // output reports that are delayed just now
  [[nodiscard]] std::uint64_t of(FaultKind kind) const noexcept {
    return by_kind[static_cast<std::size_t>(kind)];
  }
};

// The running counts behind FaultCounts. Thread: add() from one, read() from any.
class FaultTally {
 public:
  THIMBLE_RT void add(FaultKind kind, std::uint64_t n = 1) noexcept {
    by_kind_[static_cast<std::size_t>(kind)].fetch_add(n, std::memory_order_relaxed);
  }
  THIMBLE_RT void set_out_under_way(std::uint64_t reports) noexcept {
    out_under_way_.store(reports, std::memory_order_relaxed);
  }
  [[nodiscard]] FaultCounts read() const noexcept;

 private:
  std::array<std::atomic<std::uint64_t>, kFaultKindCount> by_kind_{};
  std::atomic<std::uint64_t> out_under_way_{0};
};

// What a plan says of each report of one handle or pipe: by the script, or by chance that depends
// on the seed, the kind and the report's number only.
//
// Thread: one. RT: all but the construction. Ownership: shares the tally.
class FaultDice {
 public:
  FaultDice(FaultPlan plan, std::shared_ptr<FaultTally> tally) noexcept;

  [[nodiscard]] const RandomFaults& chances() const noexcept { return plan_.random; }
  [[nodiscard]] FaultTally& tally() const noexcept { return *tally_; }
  // By the script's times alone.
  THIMBLE_RT [[nodiscard]] bool is_on(FaultKind kind, MonotonicTime t) const noexcept;
  THIMBLE_RT [[nodiscard]] bool strikes(FaultKind kind, MonotonicTime t,
                                        std::uint64_t number) const noexcept;
  // The same; counted when it does.
  THIMBLE_RT [[nodiscard]] bool injects(FaultKind kind, MonotonicTime t,
                                        std::uint64_t number) noexcept {
    const bool does_strike = strikes(kind, t, number);
    if (does_strike) tally_->add(kind);
    return does_strike;
  }
  THIMBLE_RT [[nodiscard]] bool strikes_by_chance(FaultKind kind,
                                                  std::uint64_t number) const noexcept;
  // How long the report is held up; counted unless it is 0.
  THIMBLE_RT [[nodiscard]] Duration delay_of(FaultKind kind, MonotonicTime t,
                                             std::uint64_t number) noexcept;
  // One byte of `bytes`, which are not none, becomes another one; counted. Never a corruption that
  // leaves the report as it was.
  THIMBLE_RT void corrupt(std::span<std::uint8_t> bytes, FaultKind kind,
                          std::uint64_t number) noexcept;
  // What is left of `size` bytes, which are not none: fewer; counted.
  THIMBLE_RT [[nodiscard]] std::size_t cut(std::size_t size, FaultKind kind,
                                           std::uint64_t number) noexcept;

 private:
  [[nodiscard]] const ScriptedFault* scripted(FaultKind kind, MonotonicTime t,
                                              std::uint64_t number) const noexcept;

  [[nodiscard]] double chance_of(FaultKind kind) const noexcept;

  FaultPlan plan_;
  std::shared_ptr<FaultTally> tally_;
};

}  // namespace thimble::sim
