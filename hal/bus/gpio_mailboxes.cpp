#include "hal/bus/gpio_mailboxes.hpp"

namespace thimble::bus {

IoStatus GpioMailboxes::next_edge(GpioEdge& out) noexcept {
  if (is_gone_.load()) return IoStatus::Disconnected;
  if (edges_.pop(out)) return IoStatus::Ok;
  const std::uint64_t refused = edges_.refused();
  if (refused == refusals_told_) return IoStatus::NoData;
  refusals_told_ = refused;
  return IoStatus::ProtocolError;
}

IoStatus GpioMailboxes::levels(GpioLevels& out) noexcept {
  if (is_gone_.load()) return IoStatus::Disconnected;
  if (!has_levels_.load() || !levels_.load(out)) return IoStatus::NoData;
  return IoStatus::Ok;
}

IoStatus GpioMailboxes::set(std::size_t output, bool is_high) noexcept {
  if (is_gone_.load()) return IoStatus::Disconnected;
  if (output >= outputs_) return IoStatus::ProtocolError;
  const std::uint32_t before = wanted_.load();
  const std::uint32_t bit = 1U << output;
  const bool is_late = before != written_.load();
  wanted_.store(is_high ? before | bit : before & ~bit);
  return is_late ? IoStatus::Backlogged : IoStatus::Ok;
}

void GpioMailboxes::deliver_edge(std::size_t input, bool is_high, MonotonicTime at) noexcept {
  if (input >= inputs_) return;
  InputMemory& memory = memory_[input];
  const bool is_repeated = memory.sequence > 0 && memory.is_high == is_high;
  memory.sequence += is_repeated ? 2 : 1;
  memory.is_high = is_high;
  edges_.push({static_cast<std::uint8_t>(input), is_high, at, memory.sequence});
  wake();
}

void GpioMailboxes::count_lost_edge(std::size_t input) noexcept {
  if (input < inputs_) ++memory_[input].sequence;
}

void GpioMailboxes::deliver_levels(const GpioLevels& levels) noexcept {
  levels_.store(levels);
  const bool had_levels = has_levels_.exchange(true);
  const bool is_news = !had_levels || levels.high != high_;
  high_ = levels.high;
  if (is_news) wake();
}

std::optional<std::uint32_t> GpioMailboxes::wanted() const noexcept {
  const std::uint32_t high = wanted_.load();
  if (high == written_.load()) return std::nullopt;
  return high;
}

void GpioMailboxes::written(std::uint32_t high) noexcept { written_.store(high); }

void GpioMailboxes::disconnect() noexcept {
  is_gone_.store(true);
  wake();
}

}  // namespace thimble::bus
