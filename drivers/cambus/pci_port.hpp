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

// A board over PCI, or over memory that two programs share: its page and its window
// (docs/cambus.md, section 6). What is put and got is there at once. Ownership: owns the window.
class PciPort final : public BoardPort {
 public:
  // Errors: Disconnected; and those of parse_board_facts().
  [[nodiscard]] static Result<std::unique_ptr<PciPort>> open(
      std::unique_ptr<bus::MemoryWindow> window, MonotonicTime now);

  [[nodiscard]] const BoardFacts& facts() const noexcept override { return facts_; }

  // NoData where the page changed at each look.
  IoStatus poll(MonotonicTime now, BoardStatus& out) override;
  IoStatus confirm(MonotonicTime now) override { return look_for_board(now); }
  IoStatus ring(const std::array<std::uint32_t, page::kHostRegisters>& registers,
                std::uint32_t meant) override;
  [[nodiscard]] bool is_taken(const BoardStatus& status) const noexcept override {
    return status.acknowledged == rung_;
  }
  IoStatus put(std::uint32_t offset, std::span<const std::uint8_t> bytes) override;
  IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes) override;
  // Nothing waits: what was put is there.
  void drop_unsent() override {}

  [[nodiscard]] Gone why_gone() const noexcept override { return watch_.why_gone(); }
  [[nodiscard]] const PortCounters& counters() const noexcept { return counters_; }

 private:
  PciPort(std::unique_ptr<bus::MemoryWindow> window, const BoardFacts& facts, std::uint32_t rung,
          MonotonicTime now)
      : window_(std::move(window)), facts_(facts), rung_(rung), watch_(facts, now) {}

  [[nodiscard]] IoStatus look_for_board(MonotonicTime now);
  [[nodiscard]] std::optional<BoardStatus> look_once(IoStatus& status);
  [[nodiscard]] bool is_in_window(std::uint32_t offset, std::size_t bytes) const noexcept;
  // What the window says of a transfer; remembers that it is gone.
  IoStatus note(IoStatus status) noexcept;

  std::unique_ptr<bus::MemoryWindow> window_;
  BoardFacts facts_;
  std::uint32_t rung_;
  BoardWatch watch_;
  std::vector<std::uint32_t> words_;  // on their way
  PortCounters counters_;
};

}  // namespace thimble::cambus
