#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "daemon/safety/chain_status.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/gpio_lines.hpp"

namespace thimble::safety {

// A chip that has not answered, or taken an output, for so long is as good as gone. Ours: ten
// reads, and more than a busy machine holds a thread up.
inline constexpr Duration kSilence = std::chrono::milliseconds(200);
// A chip whose kernel driver polls it tells a level before the edge; that of a CP2112, which is not
// asked for edges (decision 0516), up to 50 ms (Linux 6.1).
inline constexpr Duration kEdgePatience = std::chrono::milliseconds(150);

// What the inputs of a claim say, and whether they can be believed. Between two steps an input
// counts as what is less safe for a moment, too: a pulse is not overlooked.
//
// Thread: that of the lines. Not RT. Ownership: keeps no lines. Errors: those of a step, as its
// trouble.
class LineReader {
 public:
  explicit LineReader(std::size_t inputs) noexcept : inputs_(inputs) {}

  // `lines` was just opened.
  void restart() noexcept;
  // NoLines, Silent, EdgesLost or None.
  ChainTrouble step(bus::GpioLines& lines, MonotonicTime now) noexcept;
  // Whether the input was at that level by edge and by reading, ever since the step before.
  [[nodiscard]] bool was_always(std::size_t input, bool is_high) const noexcept;
  // The newest reading; what a step that gave NoLines or Silent leaves is the one before.
  [[nodiscard]] const bus::GpioLevels& levels() const noexcept { return levels_; }

 private:
  struct Input {
    std::uint64_t sequence{0};
    std::optional<bool> by_edge;  // nothing: none was told yet
    bool by_level{false};
    bool was_high{true};  // at some time since the last step
    bool was_low{true};
    std::optional<MonotonicTime> differs_since;
  };
  bool take_edges(bus::GpioLines& lines) noexcept;
  bool compare(Input& input, MonotonicTime now) noexcept;

  std::size_t inputs_;
  std::array<Input, bus::kMaxGpioLines> memory_{};
  bus::GpioLevels levels_{};
};

}  // namespace thimble::safety
