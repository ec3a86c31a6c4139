#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/bus/memory_window.hpp"
#include "hal/bus/shared_words.hpp"

namespace thimble::sim {

// The memory of a simulated board, as long as the board is plugged in: all 0 at first.
//
// Thread: words() from any; plugging out from one. Ownership: shared between board and windows.
class SimMemory {
 public:
  // `bytes`: a multiple of 4.
  explicit SimMemory(std::size_t bytes) : storage_(bytes / sizeof(std::uint32_t)) {}

  [[nodiscard]] bus::SharedWords words() noexcept { return bus::SharedWords(storage_); }
  [[nodiscard]] bool is_plugged() const noexcept { return is_plugged_.load(); }
  // For good: a board that comes back has another memory.
  void unplug() noexcept { is_plugged_.store(false); }

 private:
  std::vector<std::uint32_t> storage_;
  std::atomic<bool> is_plugged_{true};
};

// The host's end of it. Exact: the order of words and what is refused. Left out: how long a bus
// takes, and that PCI posts its writes.
// Thread, RT, Errors: as MemoryWindow.
class SimMemoryWindow final : public bus::MemoryWindow {
 public:
  explicit SimMemoryWindow(std::shared_ptr<SimMemory> memory) noexcept
      : memory_(std::move(memory)), words_(memory_->words()) {}

  [[nodiscard]] std::size_t bytes() const noexcept override { return words_.bytes(); }
  IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept override;
  IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept override;
  IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept override;
  IoStatus write_block(std::uint32_t offset,
                       std::span<const std::uint32_t> words) noexcept override;
  void barrier() noexcept override {}  // words are seen in order as it is

 private:
  [[nodiscard]] IoStatus check(std::uint32_t offset, std::size_t words) const noexcept;

  std::shared_ptr<SimMemory> memory_;
  bus::SharedWords words_;
};

}  // namespace thimble::sim
