#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/io_status.hpp"

namespace thimble::bus {

// What a window reads where nobody answers: PCI gives all ones, and so does every other one.
inline constexpr std::uint32_t kNobodyAnswers = 0xffffffff;

// Whether so many words lie in a window of so many bytes, aligned; none may lie at its end.
[[nodiscard]] constexpr bool lies_within(std::size_t window_bytes, std::uint32_t offset,
                                         std::size_t words) noexcept {
  if (offset % sizeof(std::uint32_t) != 0 || offset > window_bytes) return false;
  return words <= (window_bytes - offset) / sizeof(std::uint32_t);
}

// A window onto the memory of a board: words of 32 bits at byte offsets that are multiples of 4,
// each read and written whole, low byte first. Reading has no side effect. One side writes a word,
// the other reads it: what both write is lost.
//
// A board that has fallen silent reads as all ones and takes no writes, with Ok: that it is gone,
// only whoever knows its words can tell. Once the system knows, every call says Disconnected.
//
// Thread: one at a time; the board is another one. RT: not for servo threads: a read waits for the
// bus (a microsecond on PCI), and there is one for each word.
// Ownership: what stands behind the window is its own. Closing is the destructor's.
// Errors: IoStatus::Disconnected latches; ProtocolError, and nothing moves, where some of the words
// do not lie in the window or the offset is no multiple of 4. Outputs are untouched by both, but
// for a block during which the board went away.
class MemoryWindow {
 public:
  virtual ~MemoryWindow() = default;
  // In bytes, a multiple of 4; does not change.
  [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;
  virtual IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept = 0;
  virtual IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept = 0;
  // Several words, from the lowest offset on. The board may come in between any two of them.
  virtual IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept = 0;
  virtual IoStatus write_block(std::uint32_t offset,
                               std::span<const std::uint32_t> words) noexcept = 0;
  // The board sees what was written before ahead of anything that is written later.
  virtual void barrier() noexcept = 0;
};

}  // namespace thimble::bus
