#include "sim/fault/faulty_gpio.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {

FaultyGpio::FaultyGpio(std::unique_ptr<bus::GpioLines> lines, std::size_t inputs,
                       const Clock& clock, const FaultPlan& plan,
                       const std::shared_ptr<FaultTally>& tally)
    : lines_(std::move(lines)), inputs_(inputs), clock_(&clock), dice_(plan, tally) {}

IoStatus FaultyGpio::next_edge(bus::GpioEdge& out) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_gone(now)) return IoStatus::Disconnected;
  if (is_stalled(now)) return IoStatus::NoData;
  send_late(now);
  const IoStatus below = take_edges();
  if (below != IoStatus::NoData) return below;
  if (waiting_.empty() || waiting_.front().arrived_at > now) return IoStatus::NoData;
  out = waiting_.front();
  waiting_.pop_front();
  return IoStatus::Ok;
}

// All there are; NoData, or what the lines below say instead.
IoStatus FaultyGpio::take_edges() noexcept {
  bus::GpioEdge edge;
  while (true) {
    const IoStatus status = lines_->next_edge(edge);
    if (status != IoStatus::Ok) return status;
    const std::uint64_t number = ++edges_;
    if (dice_.injects(FaultKind::DropIn, edge.arrived_at, number)) continue;
    if (dice_.injects(FaultKind::CorruptIn, edge.arrived_at, number)) edge.is_high = !edge.is_high;
    edge.arrived_at = edge.arrived_at + dice_.delay_of(FaultKind::DelayIn, edge.arrived_at, number);
    if (!waiting_.empty()) {
      edge.arrived_at = std::max(edge.arrived_at, waiting_.back().arrived_at);
    }
    waiting_.push_back(edge);
  }
}

IoStatus FaultyGpio::levels(bus::GpioLevels& out) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_gone(now)) return IoStatus::Disconnected;
  if (!is_stalled(now)) {
    send_late(now);
    bus::GpioLevels fresh;
    const IoStatus status = lines_->levels(fresh);
    if (status != IoStatus::Ok) return status;
    const bool is_another = readings_ == 0 || fresh != seen_below_;
    if (is_another) note_reading(fresh, now);
    if (is_another && !dice_.injects(FaultKind::DropIn, now, readings_)) {
      if (inputs_ > 0 && dice_.injects(FaultKind::CorruptIn, now, readings_)) {
        fresh.high ^= 1U << (readings_ % inputs_);
      }
      told_ = fresh;
      has_told_ = true;
    }
  }
  if (!has_told_) return IoStatus::NoData;
  out = told_;
  return IoStatus::Ok;
}

void FaultyGpio::note_reading(const bus::GpioLevels& fresh, MonotonicTime now) noexcept {
  seen_below_ = fresh;
  ++readings_;
  if (!dice_.strikes_by_chance(FaultKind::Stall, readings_)) return;
  stalled_until_ = now + dice_.chances().stall_lasts;
  dice_.tally().add(FaultKind::Stall);
}

IoStatus FaultyGpio::set(std::size_t output, bool is_high) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_gone(now)) return IoStatus::Disconnected;
  if (output >= late_.size()) return IoStatus::ProtocolError;
  if (is_stalled(now)) return IoStatus::Backlogged;
  const std::uint64_t number = ++sets_;
  late_[output].is_waiting = false;
  if (dice_.injects(FaultKind::DropOut, now, number)) return IoStatus::Ok;
  if (dice_.injects(FaultKind::CorruptOut, now, number)) is_high = !is_high;
  const Duration delay = dice_.delay_of(FaultKind::DelayOut, now, number);
  if (delay <= Duration{}) return lines_->set(output, is_high);
  late_[output] = {true, is_high, now + delay};
  return IoStatus::Ok;
}

void FaultyGpio::send_late(MonotonicTime now) noexcept {
  for (std::size_t output = 0; output < late_.size(); ++output) {
    LateLevel& late = late_[output];
    if (!late.is_waiting || late.at > now) continue;
    late.is_waiting = false;
    static_cast<void>(lines_->set(output, late.is_high));  // nobody is there to be told
  }
}

bool FaultyGpio::is_gone(MonotonicTime now) noexcept {
  if (is_gone_ || !dice_.is_on(FaultKind::Disconnect, now)) return is_gone_;
  dice_.tally().add(FaultKind::Disconnect);
  is_gone_ = true;
  return true;
}

bool FaultyGpio::is_stalled(MonotonicTime now) noexcept {
  if (now < stalled_until_) return true;
  if (!dice_.is_on(FaultKind::Stall, now)) return false;
  dice_.tally().add(FaultKind::Stall);
  return true;
}

Result<std::unique_ptr<bus::GpioLines>> FaultyGpioChips::open(const bus::GpioClaim& claim,
                                                              rt::WakeSignal* wake) {
  const FaultDice dice(plan_, tally_);
  if (dice.is_on(FaultKind::RefuseOpen, clock_->now())) {
    tally_->add(FaultKind::RefuseOpen);
    return fail(Errc::Busy, claim.chip + " is held by somebody else");
  }
  auto lines = chips_->open(claim, wake);
  if (!lines) return lines;
  return std::make_unique<FaultyGpio>(*std::move(lines), claim.inputs.size(), *clock_, plan_,
                                      tally_);
}

}  // namespace thimble::sim
