#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>

#include "hal/base/time.hpp"
#include "hal/bus/gpio_lines.hpp"
#include "sim/fault/fault_dice.hpp"
#include "sim/fault/fault_plan.hpp"

namespace thimble::sim {

// Lines of any GPIO chip behind a bad adapter: passes everything on, but for what the plan says.
//
// An edge, a reading of the levels and a level that is set are its reports, each counted for
// itself. In: DropIn, an edge is never told, and its number is used up, so that whoever counts sees
// the gap; a reading never comes, so that the last one gets old. CorruptIn, an edge says the other
// level; in a reading one input is the other way round. DelayIn, an edge is told and stamped later;
// edges never overtake each other. Out: DropOut, the level never reaches the wire; CorruptOut, the
// other one does; DelayOut, it does with the first call after its delay, unless a newer one did.
// Stall: the chip answers nothing; edges wait, levels get old, sets are Backlogged and lost.
// Disconnect latches. Other kinds mean nothing here.
//
// Thread: as GpioLines. Ownership: owns the lines below. The clock must outlive it and be the one
// that stamps below.
class FaultyGpio final : public bus::GpioLines {
 public:
  FaultyGpio(std::unique_ptr<bus::GpioLines> lines, std::size_t inputs, const Clock& clock,
             const FaultPlan& plan,
             const std::shared_ptr<FaultTally>& tally = std::make_shared<FaultTally>());

  IoStatus next_edge(bus::GpioEdge& out) noexcept override;
  IoStatus levels(bus::GpioLevels& out) noexcept override;
  IoStatus set(std::size_t output, bool is_high) noexcept override;
  [[nodiscard]] FaultCounts injected() const noexcept { return dice_.tally().read(); }

 private:
  struct LateLevel {
    bool is_waiting{false};
    bool is_high{false};
    MonotonicTime at{};
  };

  [[nodiscard]] bool is_gone(MonotonicTime now) noexcept;
  [[nodiscard]] bool is_stalled(MonotonicTime now) noexcept;
  IoStatus take_edges() noexcept;
  void note_reading(const bus::GpioLevels& fresh, MonotonicTime now) noexcept;
  void send_late(MonotonicTime now) noexcept;

  std::unique_ptr<bus::GpioLines> lines_;
  std::size_t inputs_;
  const Clock* clock_;
  FaultDice dice_;
  bool is_gone_{false};
  MonotonicTime stalled_until_{Duration::min()};
  std::uint64_t edges_{0};
  std::deque<bus::GpioEdge> waiting_;  // by arrived_at
  std::uint64_t readings_{0};
  bus::GpioLevels seen_below_{};
  bus::GpioLevels told_{};
  bool has_told_{false};
  std::uint64_t sets_{0};
  std::array<LateLevel, bus::kMaxGpioLines> late_{};
};

// Every lines that are opened through it are wrapped; RefuseOpen: Busy.
// Ownership: the chips, the clock and the tally outlive the lines; the plan is copied.
class FaultyGpioChips final : public bus::GpioChips {
 public:
  FaultyGpioChips(bus::GpioChips& chips, const Clock& clock, FaultPlan plan)
      : chips_(&chips), clock_(&clock), plan_(std::move(plan)) {}
  [[nodiscard]] Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                             rt::WakeSignal* wake) override;
  [[nodiscard]] FaultCounts injected() const noexcept { return tally_->read(); }

 private:
  bus::GpioChips* chips_;
  const Clock* clock_;
  FaultPlan plan_;
  std::shared_ptr<FaultTally> tally_{std::make_shared<FaultTally>()};
};

}  // namespace thimble::sim
