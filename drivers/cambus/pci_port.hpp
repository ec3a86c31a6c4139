#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/cambus/board_port.hpp"
#include "drivers/cambus/board_watch.hpp"
#include "hal/bus/memory_window.hpp"

namespace thimble::cambus {

// How many words of 32 bits a turn moves at most, beside the page's.
struct PciTurn {
  std::size_t reads{0};
  std::size_t writes{0};
};
// Ours, half a millisecond: an uncached read waits for the bus, about a microsecond; a write is
// posted and costs an eighth of it.
inline constexpr PciTurn kBusTurn{512, 4096};
// Of what is memory of this computer: likewise, at some nanoseconds a word.
inline constexpr PciTurn kMemoryTurn{std::size_t{1} << 17, std::size_t{1} << 17};

// A board over PCI, or over memory that two programs share: its page and its window
// (docs/cambus.md, section 6). What is put and got takes as many turns as it has words for: the
// thread that moves them serves others. Ownership: owns the window.
class PciPort final : public BoardPort {
 public:
  // Errors: Disconnected; and those of parse_board_facts().
  [[nodiscard]] static Result<std::unique_ptr<PciPort>> open(
      std::unique_ptr<bus::MemoryWindow> window, MonotonicTime now, const PciTurn& turn = kBusTurn);

  [[nodiscard]] const BoardFacts& facts() const noexcept override { return facts_; }

  // NoData where the page changed at each look.
  IoStatus poll(MonotonicTime now, BoardStatus& out) override;
  IoStatus confirm(MonotonicTime now) override;
  IoStatus ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                std::uint32_t meant) override;
  [[nodiscard]] bool is_taken(const BoardStatus& status) const noexcept override {
    return status.acknowledged == rung_;
  }
  void begin_turn() override { left_ = turn_; }
  IoStatus put(std::uint32_t offset, std::span<const std::uint8_t> bytes) override;
  // One after the other. What was asked for is forgotten with the next ring().
  IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes) override;
  void drop_unsent() override;

  [[nodiscard]] Gone why_gone() const noexcept override { return watch_.why_gone(); }
  [[nodiscard]] const PortCounters& counters() const noexcept { return counters_; }

 private:
  PciPort(std::unique_ptr<bus::MemoryWindow> window, const BoardFacts& facts, std::uint32_t rung,
          MonotonicTime now, const PciTurn& turn)
      : window_(std::move(window)),
        facts_(facts),
        rung_(rung),
        watch_(facts, now),
        turn_(turn),
        left_(turn) {}

  // What is on its way, and how far.
  struct Moving {
    std::uint32_t offset{0};
    std::size_t words{0};
    std::size_t done{0};

    [[nodiscard]] bool is_it(std::uint32_t of, std::size_t bytes) const noexcept;
    [[nodiscard]] std::uint32_t next() const noexcept;  // where, in the window
    [[nodiscard]] bool is_done() const noexcept { return done == words; }
  };

  [[nodiscard]] IoStatus look_for_board(MonotonicTime now);
  [[nodiscard]] std::optional<BoardStatus> look_once(IoStatus& status);
  [[nodiscard]] bool is_in_window(std::uint32_t offset, std::size_t bytes) const noexcept;
  // What the window says of a transfer; remembers that it is gone.
  IoStatus note(IoStatus status) noexcept;

  std::unique_ptr<bus::MemoryWindow> window_;
  BoardFacts facts_;
  std::uint32_t rung_;
  BoardWatch watch_;
  PciTurn turn_;
  PciTurn left_;  // of this one
  std::optional<Moving> putting_;
  std::optional<Moving> getting_;
  std::vector<std::uint32_t> got_;      // of getting_
  std::vector<std::uint32_t> leaving_;  // in this call
  PortCounters counters_;
};

}  // namespace thimble::cambus
