#pragma once

#include <functional>
#include <memory>

#include "hal/device/wrapped_cam_board.hpp"

namespace thimble::session {

// The same board; says `when_it_works` when its first program is over, once. Thread, errors: as
// CamBoard. Ownership: owns the board.
class ProvenBoard final : public WrappedCamBoard {
 public:
  ProvenBoard(std::unique_ptr<CamBoard> board, std::function<void()> when_it_works);

  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime now) override;

 private:
  std::function<void()> when_it_works_;  // empty once said
};

}  // namespace thimble::session
