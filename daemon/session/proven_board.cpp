#include "daemon/session/proven_board.hpp"

#include <utility>

namespace thimble::session {

ProvenBoard::ProvenBoard(std::unique_ptr<CamBoard> board, std::function<void()> when_it_works)
    : WrappedCamBoard(std::move(board)), when_it_works_(std::move(when_it_works)) {}

Result<std::optional<CamAnswer>> ProvenBoard::poll(MonotonicTime now) {
  Result<std::optional<CamAnswer>> answer = WrappedCamBoard::poll(now);
  if (answer && *answer && when_it_works_) std::exchange(when_it_works_, nullptr)();
  return answer;
}

}  // namespace thimble::session
