#include "hal/bus/gpio_mailboxes.hpp"

#include <utility>

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
  const GpioWish before = wanted_.load();
  const std::uint32_t bit = 1U << output;
  const std::uint32_t high = is_high ? before.high | bit : before.high & ~bit;
  if (high != before.high) wanted_.store({before.number + 1, high});
  const std::uint32_t written = written_.load();
  const bool was_one_written = std::exchange(written_at_last_set_, written) != written;
  const bool is_late = before.number != written && !was_one_written;
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

std::optional<GpioWish> GpioMailboxes::wanted() const noexcept {
  const GpioWish wish = wanted_.load();
  if (wish.number == written_.load()) return std::nullopt;
  return wish;
}

void GpioMailboxes::written(const GpioWish& wish) noexcept { written_.store(wish.number); }

void GpioMailboxes::disconnect() noexcept {
  is_gone_.store(true);
  wake();
}

}  // namespace thimble::bus
