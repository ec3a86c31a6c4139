#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "hal/bus/gpio_lines.hpp"
#include "hal/rt/spsc_ring.hpp"
#include "hal/rt/word_seqlock.hpp"

namespace thimble::bus {

// The levels that the outputs shall have. Aligned as one word: so its atomic is one for every
// compiler.
struct alignas(std::uint64_t) GpioWish {
  std::uint32_t number{0};  // of this wish; 0: low, as they are opened
  std::uint32_t high{0};    // bit i: output i
};

// The end of opened lines that every implementation has in common, and the mailboxes between it and
// the thread that talks to the chip.
//
// Thread: GpioLines' functions from one, those of the bus from one other.
// Real-time class: no allocation, no system call but the wake's.
// Ownership: the wake must outlive it. Errors: as GpioLines.
class GpioMailboxes : public GpioLines {
 public:
  // At most kMaxGpioLines of each, as check() of a claim has it. `wake` may be nullptr.
  GpioMailboxes(std::size_t inputs, std::size_t outputs, rt::WakeSignal* wake) noexcept
      : inputs_(inputs), outputs_(outputs), wake_(wake) {}

  IoStatus next_edge(GpioEdge& out) noexcept override;
  IoStatus levels(GpioLevels& out) noexcept override;
  IoStatus set(std::size_t output, bool is_high) noexcept override;

  // Of the bus; `input`: below inputs(). One that repeats the level before it comes after one that
  // was lost.
  void deliver_edge(std::size_t input, bool is_high, MonotonicTime at) noexcept;
  // One was lost, or may have been: a hole before the next that is delivered.
  void count_lost_edge(std::size_t input) noexcept;
  void deliver_levels(const GpioLevels& levels) noexcept;
  // The newest wish, until all of it is written. A level that came back to what it was is another
  // wish: nobody knows what the chip did with the one between.
  [[nodiscard]] std::optional<GpioWish> wanted() const noexcept;
  // The chip has taken all of it.
  void written(const GpioWish& wish) noexcept;
  void disconnect() noexcept;

  [[nodiscard]] bool is_disconnected() const noexcept { return is_gone_.load(); }
  [[nodiscard]] std::size_t inputs() const noexcept { return inputs_; }
  [[nodiscard]] std::size_t outputs() const noexcept { return outputs_; }

 private:
  static constexpr std::size_t kWaitingEdges = 256;  // ours: 16 of each line wait in Linux 6.1

  struct InputMemory {
    std::uint64_t sequence{0};
    bool is_high{false};
  };

  void wake() const noexcept {
    if (wake_ != nullptr) wake_->signal();
  }

  std::size_t inputs_;
  std::size_t outputs_;
  rt::WakeSignal* wake_;
  std::array<InputMemory, kMaxGpioLines> memory_{};  // of the bus
  std::uint32_t high_{0};                            // of the bus: the levels before
  rt::SpscRing<GpioEdge, kWaitingEdges> edges_;
  std::uint64_t refusals_told_{0};  // of the user
  rt::WordSeqlock<GpioLevels> levels_;
  std::atomic<bool> has_levels_{false};
  std::atomic<GpioWish> wanted_{};
  std::atomic<std::uint32_t> written_{0};  // number of a wish
  std::uint32_t written_at_last_set_{0};   // of the user
  std::atomic<bool> is_gone_{false};
};

}  // namespace thimble::bus
