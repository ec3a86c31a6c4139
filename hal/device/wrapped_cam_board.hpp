#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "hal/device/cam_board.hpp"

namespace thimble {

// Another board, as it is: for who changes one of its answers. Thread, errors: as CamBoard.
// Ownership: owns the board.
class WrappedCamBoard : public CamBoard {
 public:
  explicit WrappedCamBoard(std::unique_ptr<CamBoard> board) : board_(std::move(board)) {}

  [[nodiscard]] const CamBoardInfo& info() const noexcept override { return board_->info(); }
  [[nodiscard]] Result<void> lay_out(const CamGeometry& geometry) override {
    return board_->lay_out(geometry);
  }
  [[nodiscard]] bool needs_lay_out() const noexcept override { return board_->needs_lay_out(); }
  [[nodiscard]] Result<void> start(const CamSteps& steps, Duration at_most,
                                   MonotonicTime now) override {
    return board_->start(steps, at_most, now);
  }
  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime now) override {
    return board_->poll(now);
  }
  [[nodiscard]] bool is_running() const noexcept override { return board_->is_running(); }
  [[nodiscard]] const CamBoardCounters& counters() const noexcept override {
    return board_->counters();
  }

 private:
  std::unique_ptr<CamBoard> board_;
};

}  // namespace thimble
