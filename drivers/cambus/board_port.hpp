#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/cambus/board_facts.hpp"
#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"

namespace thimble::cambus {

// Why a board is given up. Latched: only another port finds it again.
enum class Gone : std::uint8_t { No, Unplugged, Silent, NewIncarnation, NoBeat };
[[nodiscard]] std::string_view to_string(Gone why) noexcept;

struct PortCounters {
  std::uint64_t polls{0};
  std::uint64_t restless{0};   // polls that found no moment at which the page stood still
  std::uint64_t rings{0};      // doorbells
  std::uint64_t held_back{0};  // and those that had to wait for the one before
  bool operator==(const PortCounters&) const = default;
};

// The page and the window of a board, whatever carries them (docs/cambus.md, sections 6 and 7).
// No call waits: each looks or writes once, or says that it has to be made again.
//
// Thread: one at a time. Errors: IoStatus::Disconnected latches, why_gone() says why;
// ProtocolError, and nothing moves, for what does not lie in the board's window.
class BoardPort {
 public:
  virtual ~BoardPort() = default;

  [[nodiscard]] virtual const BoardFacts& facts() const noexcept = 0;
  // The page as of one moment. NoData, and `out` untouched: none was found, or it is on its way.
  virtual IoStatus poll(MonotonicTime now, BoardStatus& out) = 0;
  // Whether the board that was opened is still there: what was read before is its.
  virtual IoStatus confirm(MonotonicTime now) = 0;
  // Register n is meant where bit n of `meant` is set; behind all that was put before. Backlogged,
  // and nothing is written, until the board has taken the last one.
  virtual IoStatus ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                        std::uint32_t meant) = 0;
  // Whether the board has taken what was rung last, as of `status`.
  [[nodiscard]] virtual bool is_taken(const BoardStatus& status) const noexcept = 0;
  // Of the thread of who calls: what put() and get() do in one is bounded.
  virtual void begin_turn() {}
  // Bytes of the board's window, at an offset in it; both multiples of 4. Backlogged, the port has
  // no room for all of them now: they are written when the same is put again, often enough.
  virtual IoStatus put(std::uint32_t offset, std::span<const std::uint8_t> bytes) = 0;
  // NoData, `bytes` untouched: they are on their way to who asks for the same again.
  virtual IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes) = 0;
  // What was put, rung and asked for is of no use any more: what has not left yet does not leave,
  // and what is put next begins at its beginning. The board may have had a part of it.
  virtual void drop_unsent() = 0;

  // How fast a list goes to the board, about; 0: as memory does.
  [[nodiscard]] virtual std::uint32_t bytes_per_s() const noexcept { return 0; }

  [[nodiscard]] virtual Gone why_gone() const noexcept = 0;
};

}  // namespace thimble::cambus
