#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "hal/base/time.hpp"

namespace thimble::safety {

inline constexpr std::size_t kMaxEstopChannels = 2;
// Two contacts of one button do not move together to the millisecond. The plan's.
inline constexpr Duration kDisagreement = std::chrono::milliseconds(50);

// The normally closed channels of an emergency stop. One that is open, by whatever it is told, is a
// stop. Two that were read at different levels for longer than kDisagreement are a defect as well,
// which stays until both were read open together: a contact that is welded cannot be made good by
// releasing the button.
//
// Thread: one. Pure.
class EstopChannels {
 public:
  // 1 or 2.
  explicit EstopChannels(std::size_t channels) noexcept : channels_(channels) {}

  // By edge and by level.
  void step(std::span<const bool> is_closed) noexcept;
  // By the levels alone, read together at `read_at`. Edges will not do: a chip that is polled for
  // them tells those of two contacts up to a poll apart, which is as long as kDisagreement.
  void compare(std::span<const bool> is_read_closed, MonotonicTime read_at) noexcept;
  [[nodiscard]] bool is_open() const noexcept { return is_open_; }
  [[nodiscard]] bool has_disagreed() const noexcept { return has_disagreed_; }

 private:
  [[nodiscard]] std::size_t count_closed(std::span<const bool> is_closed) const noexcept;

  std::size_t channels_;
  bool is_open_{true};
  bool has_disagreed_{false};
  std::optional<MonotonicTime> disagree_since_;
};

}  // namespace thimble::safety
