#include "sim/model/cam/sync_pulses.hpp"

namespace thimble::sim::cam {
namespace {

[[nodiscard]] std::uint64_t next_multiple(std::uint64_t of, std::uint64_t from) noexcept {
  return (from + of - 1) / of * of;
}

}  // namespace

SyncPulses::SyncPulses(const SyncLengths& lengths, std::uint64_t start_clocks)
    : line_clocks_(std::uint64_t{lengths.scan_clocks} + lengths.blank_clocks),
      scan_lines_(lengths.scan_lines),
      frame_lines_(std::uint64_t{lengths.scan_lines} + lengths.blank_lines),
      start_(start_clocks) {
  if (scan_lines_ == 0) line_clocks_ = 0;
}

std::uint64_t SyncPulses::next_line(std::uint64_t now_clocks) const noexcept {
  const std::uint64_t at = start_ + next_multiple(line_clocks_, now_clocks - start_);
  return place_of(at).line == scan_lines_ ? at + line_clocks_ : at;
}

std::uint64_t SyncPulses::next_frame(std::uint64_t now_clocks) const noexcept {
  return start_ + next_multiple(line_clocks_ * frame_lines_, now_clocks - start_);
}

SyncPulses::Place SyncPulses::place_of(std::uint64_t now_clocks) const noexcept {
  const std::uint64_t lines = (now_clocks - start_) / line_clocks_;
  return {lines / frame_lines_, lines % frame_lines_};
}

}  // namespace thimble::sim::cam
