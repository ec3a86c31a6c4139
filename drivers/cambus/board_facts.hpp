#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/cambus/cam_space.hpp"
#include "drivers/cambus/cambus_page_wire.hpp"
#include "hal/base/result.hpp"

namespace thimble::cambus {

// What a board says of itself, once.
struct BoardFacts {
  BoardShape shape;
  std::uint32_t clock_hz{0};
  std::uint32_t window_offset{0};  // in the BAR
  std::uint32_t window_bytes{0};
  std::uint32_t incarnation{0};
};

// From the first words of its page, of a BAR of so many bytes. Pure and total.
// Errors: NotMine (no board of ours), Unsupported (another version), Malformed.
[[nodiscard]] Result<BoardFacts> parse_board_facts(std::span<const std::uint32_t> words,
                                                   std::size_t bar_bytes);

// The words of a page that change, as of one moment.
struct BoardStatus {
  std::array<std::uint32_t, page::kHostRegisters> registers{};
  std::uint32_t acknowledged{0};
  std::array<std::uint32_t, page::kInterrupts> raised{};

  [[nodiscard]] std::uint32_t count(page::Interrupt which) const noexcept {
    return raised[static_cast<std::size_t>(which)];
  }
  [[nodiscard]] bool is_list_pending() const noexcept { return has(page::kIsListPending); }
  [[nodiscard]] bool has_exception() const noexcept { return has(page::kHasException); }
  [[nodiscard]] bool is_waiting() const noexcept { return has(page::kIsWaiting); }
  [[nodiscard]] bool is_halted() const noexcept { return has(page::kIsHalted); }
  // Where the instruction under way lies, and the one before it.
  [[nodiscard]] std::uint32_t current() const noexcept { return registers[2] & page::kListPointer; }
  [[nodiscard]] std::uint32_t previous() const noexcept {
    return registers[3] & page::kListPointer;
  }

 private:
  [[nodiscard]] bool has(std::uint32_t flag) const noexcept { return (registers[0] & flag) != 0; }
};

// From the words from the registers to the version word, both counted.
[[nodiscard]] BoardStatus parse_board_status(
    std::span<const std::uint32_t, page::kStatusBytes / 4> words) noexcept;

}  // namespace thimble::cambus
