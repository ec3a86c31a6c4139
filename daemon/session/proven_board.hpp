#pragma once

#include <functional>
#include <memory>

#include "hal/device/cam_board.hpp"

namespace thimble::session {

// The same board; says `when_it_works` when its first program is over, once. Thread, errors: as
// CamBoard. Ownership: owns the board.
class ProvenBoard final : public CamBoard {
 public:
  ProvenBoard(std::unique_ptr<CamBoard> board, std::function<void()> when_it_works);

  [[nodiscard]] const CamBoardInfo& info() const noexcept override { return board_->info(); }
  [[nodiscard]] Result<void> lay_out(const CamGeometry& geometry) override {
    return board_->lay_out(geometry);
  }
  [[nodiscard]] bool needs_lay_out() const noexcept override { return board_->needs_lay_out(); }
  [[nodiscard]] Result<void> start(const CamSteps& steps, Duration at_most,
                                   MonotonicTime now) override {
    return board_->start(steps, at_most, now);
  }
  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime now) override;
  [[nodiscard]] bool is_running() const noexcept override { return board_->is_running(); }
  [[nodiscard]] const CamBoardCounters& counters() const noexcept override {
    return board_->counters();
  }

 private:
  std::unique_ptr<CamBoard> board_;
  std::function<void()> when_it_works_;  // empty once said
};

}  // namespace thimble::session
