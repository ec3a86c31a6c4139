#include "sim/model/cam/sim_cam_board.hpp"

namespace thimble::sim::cam {
namespace {

// What is written is seen by the board at that time, not when somebody looks the next time.
class ServedWindow final : public bus::MemoryWindow {
 public:
  ServedWindow(SimCamBoard& board, std::shared_ptr<SimMemory> memory)
      : board_(&board), window_(std::move(memory)) {}

  [[nodiscard]] std::size_t bytes() const noexcept override { return window_.bytes(); }
  IoStatus read(std::uint32_t offset, std::uint32_t& out) noexcept override {
    board_->serve();
    return window_.read(offset, out);
  }
  IoStatus write(std::uint32_t offset, std::uint32_t word) noexcept override {
    return write_block(offset, {&word, 1});
  }
  IoStatus read_block(std::uint32_t offset, std::span<std::uint32_t> out) noexcept override {
    board_->serve();
    return window_.read_block(offset, out);
  }
  IoStatus write_block(std::uint32_t offset,
                       std::span<const std::uint32_t> words) noexcept override {
    board_->serve();
    const IoStatus status = window_.write_block(offset, words);
    board_->serve();
    return status;
  }
  void barrier() noexcept override { window_.barrier(); }

 private:
  SimCamBoard* board_;
  SimMemoryWindow window_;
};

}  // namespace

SimCamBoard::SimCamBoard(const Clock& clock, const BoardOptions& options)
    : clock_(&clock),
      options_(options),
      memory_(std::make_shared<SimMemory>(BoardPage::bytes_of(options))) {
  board_.emplace(options_, memory_->words(), clock_->now());
}

std::unique_ptr<bus::MemoryWindow> SimCamBoard::open_window() {
  return std::make_unique<ServedWindow>(*this, memory_);
}

void SimCamBoard::power_cycle() {
  const bus::SharedWords words = memory_->words();
  for (std::uint32_t at = 0; at < words.bytes(); at += sizeof(at)) words.store(at, 0);
  ++options_.incarnation;
  board_.emplace(options_, words, clock_->now());
}

void SimCamBoard::serve() {
  if (!is_frozen_ && memory_->is_plugged()) board_->serve(clock_->now());
}

}  // namespace thimble::sim::cam
