#include "sim/bus/sim_memory_window.hpp"

namespace thimble::sim {

IoStatus SimMemoryWindow::check(std::uint32_t offset, std::size_t words) const noexcept {
  if (!memory_->is_plugged()) return IoStatus::Disconnected;
  return bus::lies_within(bytes(), offset, words) ? IoStatus::Ok : IoStatus::ProtocolError;
}

IoStatus SimMemoryWindow::read(std::uint32_t offset, std::uint32_t& out) noexcept {
  return read_block(offset, {&out, 1});
}

IoStatus SimMemoryWindow::write(std::uint32_t offset, std::uint32_t word) noexcept {
  return write_block(offset, {&word, 1});
}

IoStatus SimMemoryWindow::read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept {
  const IoStatus status = check(offset, out.size());
  if (status != IoStatus::Ok) return status;
  for (std::uint32_t& word : out) {
    word = words_.load(offset);
    offset += sizeof(word);
  }
  return status;
}

IoStatus SimMemoryWindow::write_block(std::uint32_t offset,
                                      std::span<const std::uint32_t> words) noexcept {
  const IoStatus status = check(offset, words.size());
  if (status != IoStatus::Ok) return status;
  for (const std::uint32_t word : words) {
    words_.store(offset, word);
    offset += sizeof(word);
  }
  return status;
}

}  // namespace thimble::sim
