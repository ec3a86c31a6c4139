#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/cambus/board_facts.hpp"
#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/memory_window.hpp"

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

// A board over PCI, or over memory that two programs share: its page and its window
// (docs/cambus.md, section 6). Each call looks or writes once and never waits.
//
// Thread: one at a time. Ownership: owns the window.
// Errors: IoStatus::Disconnected latches, why_gone() says why; ProtocolError, and nothing moves,
// for what does not lie in the board's window.
class PciPort {
 public:
  // Errors: Disconnected; and those of parse_board_facts().
  [[nodiscard]] static Result<std::unique_ptr<PciPort>> open(
      std::unique_ptr<bus::MemoryWindow> window, MonotonicTime now);

  [[nodiscard]] const BoardFacts& facts() const noexcept { return facts_; }

  // The page as of one moment. NoData, and `out` untouched, where it changed at each look.
  IoStatus poll(MonotonicTime now, BoardStatus& out);
  // Whether the board that was opened is still there: what was read before is its.
  IoStatus confirm(MonotonicTime now) { return look_for_board(now); }
  // Register n is meant where bit n of `meant` is set. Backlogged, and nothing is written, until
  // the board has taken the last one.
  IoStatus ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                std::uint32_t meant);
  // Whether the board has taken what was rung last, as of `status`.
  [[nodiscard]] bool is_taken(const BoardStatus& status) const noexcept {
    return status.acknowledged == rung_;
  }
  // Bytes of the board's window, at an offset in it; both multiples of 4.
  IoStatus put(std::uint32_t offset, std::span<const std::uint8_t> bytes);
  IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes);

  [[nodiscard]] Gone why_gone() const noexcept { return gone_; }
  [[nodiscard]] const PortCounters& counters() const noexcept { return counters_; }

 private:
  PciPort(std::unique_ptr<bus::MemoryWindow> window, const BoardFacts& facts, std::uint32_t rung,
          MonotonicTime now)
      : window_(std::move(window)), facts_(facts), rung_(rung), beat_at_(now) {}

  [[nodiscard]] IoStatus look_for_board(MonotonicTime now);
  [[nodiscard]] std::optional<BoardStatus> look_once(IoStatus& status);
  [[nodiscard]] bool is_in_window(std::uint32_t offset, std::size_t bytes) const noexcept;
  // What the window says of a transfer; remembers that it is gone.
  IoStatus note(IoStatus status) noexcept;
  IoStatus give_up(Gone why) noexcept;

  std::unique_ptr<bus::MemoryWindow> window_;
  BoardFacts facts_;
  std::uint32_t rung_;
  std::optional<std::uint32_t> beat_;
  MonotonicTime beat_at_;
  Gone gone_{Gone::No};
  std::vector<std::uint32_t> words_;  // on their way
  PortCounters counters_;
};

}  // namespace thimble::cambus
