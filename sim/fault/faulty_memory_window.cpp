#include "sim/fault/faulty_memory_window.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {
namespace {

std::span<std::uint8_t> bytes_of(std::span<std::uint32_t> words) noexcept {
  return {reinterpret_cast<std::uint8_t*>(words.data()), words.size_bytes()};
}

}  // namespace

FaultyMemoryWindow::FaultyMemoryWindow(std::unique_ptr<bus::MemoryWindow> window,
                                       const Clock& clock, const FaultPlan& plan,
                                       const std::shared_ptr<FaultTally>& tally)
    : window_(std::move(window)), clock_(&clock), dice_(plan, tally) {}

IoStatus FaultyMemoryWindow::read(std::uint32_t offset, std::uint32_t& out) noexcept {
  return read_block(offset, {&out, 1});
}

IoStatus FaultyMemoryWindow::write(std::uint32_t offset, std::uint32_t word) noexcept {
  return write_block(offset, {&word, 1});
}

// Reading below changes nothing there, so it is done whatever becomes of it.
IoStatus FaultyMemoryWindow::read_block(std::uint32_t offset,
                                        std::span<std::uint32_t> out) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_gone(now)) return IoStatus::Disconnected;
  const IoStatus status = window_->read_block(offset, out);
  if (status != IoStatus::Ok || out.empty()) return status;
  const std::uint64_t number = ++reads_;
  if (dice_.strikes_by_chance(FaultKind::Stall, number)) {
    stalled_until_ = now + dice_.chances().stall_lasts;
    dice_.tally().add(FaultKind::Stall);
  }
  if (is_stalled(now) || dice_.injects(FaultKind::DropIn, now, number)) {
    std::fill(out.begin(), out.end(), bus::kNobodyAnswers);
    return status;
  }
  if (dice_.strikes(FaultKind::CorruptIn, now, number)) {
    dice_.corrupt(bytes_of(out), FaultKind::CorruptIn, number);
  }
  if (dice_.strikes(FaultKind::TruncateIn, now, number)) {
    const std::size_t left = dice_.cut(out.size(), FaultKind::TruncateIn, number);
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(left), out.end(), bus::kNobodyAnswers);
  }
  return status;
}

IoStatus FaultyMemoryWindow::write_block(std::uint32_t offset,
                                         std::span<const std::uint32_t> words) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_gone(now)) return IoStatus::Disconnected;
  const IoStatus status = window_->write_block(offset, {});  // which moves nothing
  if (status != IoStatus::Ok || words.empty()) return status;
  if (!bus::lies_within(window_->bytes(), offset, words.size())) return IoStatus::ProtocolError;
  const std::uint64_t number = ++writes_;
  if (is_stalled(now) || dice_.injects(FaultKind::DropOut, now, number)) return status;
  damaged_.assign(words.begin(), words.end());
  std::size_t left = damaged_.size();
  if (dice_.strikes(FaultKind::CorruptOut, now, number)) {
    dice_.corrupt(bytes_of(damaged_), FaultKind::CorruptOut, number);
  }
  if (dice_.strikes(FaultKind::TruncateOut, now, number)) {
    left = dice_.cut(left, FaultKind::TruncateOut, number);
  }
  return window_->write_block(offset, std::span(damaged_).first(left));
}

bool FaultyMemoryWindow::is_gone(MonotonicTime now) noexcept {
  if (is_gone_ || !dice_.is_on(FaultKind::Disconnect, now)) return is_gone_;
  dice_.tally().add(FaultKind::Disconnect);
  is_gone_ = true;
  return true;
}

bool FaultyMemoryWindow::is_stalled(MonotonicTime now) noexcept {
  if (now < stalled_until_) return true;
  if (!dice_.is_on(FaultKind::Stall, now)) return false;
  dice_.tally().add(FaultKind::Stall);
  return true;
}

}  // namespace thimble::sim
