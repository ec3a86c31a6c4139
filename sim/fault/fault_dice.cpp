#include "sim/fault/fault_dice.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {

FaultCounts FaultTally::read() const noexcept {
  FaultCounts counts;
  for (std::size_t i = 0; i < kFaultKindCount; ++i) {
    counts.by_kind[i] = by_kind_[i].load(std::memory_order_relaxed);
  }
  counts.out_under_way = out_under_way_.load(std::memory_order_relaxed);
  return counts;
}

FaultDice::FaultDice(FaultPlan plan, std::shared_ptr<FaultTally> tally) noexcept
    : plan_(std::move(plan)), tally_(std::move(tally)) {}

bool FaultDice::is_on(FaultKind kind, MonotonicTime t) const noexcept {
  return std::any_of(plan_.script.begin(), plan_.script.end(), [&](const ScriptedFault& fault) {
    return fault.kind == kind && fault.covers(t);
  });
}

double FaultDice::chance_of(FaultKind kind) const noexcept {
  switch (kind) {
    case FaultKind::DropIn:
      return plan_.random.drop_in;
    case FaultKind::DropOut:
      return plan_.random.drop_out;
    case FaultKind::DelayIn:
      return plan_.random.delay_in;
    case FaultKind::DelayOut:
      return plan_.random.delay_out;
    case FaultKind::CorruptIn:
      return plan_.random.corrupt_in;
    case FaultKind::CorruptOut:
      return plan_.random.corrupt_out;
    case FaultKind::TruncateIn:
      return plan_.random.truncate_in;
    case FaultKind::TruncateOut:
      return plan_.random.truncate_out;
    case FaultKind::Stall:
      return plan_.random.stall;
    case FaultKind::Halt:
      return plan_.random.halt;
    case FaultKind::Babble:
      return plan_.random.babble;
    case FaultKind::Disconnect:
    case FaultKind::RefuseOpen:
    case FaultKind::LoseEvents:
    case FaultKind::DelayEvents:
      return 0;
  }
  return 0;
}

const ScriptedFault* FaultDice::scripted(FaultKind kind, MonotonicTime t,
                                         std::uint64_t number) const noexcept {
  for (const ScriptedFault& fault : plan_.script) {
    if (fault.kind == kind && fault.covers(t) && fault.covers(number)) return &fault;
  }
  return nullptr;
}

bool FaultDice::strikes(FaultKind kind, MonotonicTime t, std::uint64_t number) const noexcept {
  return scripted(kind, t, number) != nullptr || strikes_by_chance(kind, number);
}

bool FaultDice::strikes_by_chance(FaultKind kind, std::uint64_t number) const noexcept {
  return fault_strikes(fault_bits(plan_.seed, kind, number), chance_of(kind));
}

Duration FaultDice::delay_of(FaultKind kind, MonotonicTime t, std::uint64_t number) noexcept {
  Duration delay{};
  const ScriptedFault* fault = scripted(kind, t, number);
  if (fault != nullptr) delay = fault->delay;
  const auto longest = static_cast<std::uint64_t>(plan_.random.max_delay.count());
  if (strikes_by_chance(kind, number) && longest > 0) {
    const std::uint64_t length = fault_bits(plan_.seed + 1, kind, number) % longest;
    delay += Duration(static_cast<std::int64_t>(length + 1));
  }
  if (delay > Duration(0)) tally_->add(kind);
  return delay;
}

void FaultDice::corrupt(std::span<std::uint8_t> bytes, FaultKind kind,
                        std::uint64_t number) noexcept {
  const std::uint64_t bits = fault_bits(plan_.seed + 1, kind, number);
  const auto change = static_cast<std::uint8_t>(1 + (bits >> 32U) % 255);
  std::uint8_t& byte = bytes[(bits & 0xffffffffU) % bytes.size()];
  byte = static_cast<std::uint8_t>(byte ^ change);
  tally_->add(kind);
}

std::size_t FaultDice::cut(std::size_t size, FaultKind kind, std::uint64_t number) noexcept {
  tally_->add(kind);
  return fault_bits(plan_.seed + 1, kind, number) % size;
}

}  // namespace thimble::sim
