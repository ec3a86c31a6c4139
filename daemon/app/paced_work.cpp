#include "daemon/app/paced_work.hpp"

#include <algorithm>
#include <utility>

namespace thimble::app {

void PacedWork::submit(api::ClientId client, Piece piece) {
  waits_.push_back({client, std::move(piece)});
}

void PacedWork::client_gone(api::ClientId client) {
  std::erase_if(waits_, [client](const Wait& wait) { return wait.client == client; });
}

void PacedWork::poll() {
  if (waits_.empty() || clock_->now() < rests_until_) return;
  // Taken out first: it may bring the next request, or the end of its client.
  const Piece piece = std::move(waits_.front().piece);
  waits_.pop_front();
  finish(piece);
}

void PacedWork::finish(const Piece& piece) {
  const MonotonicTime begun = clock_->now();
  piece();
  const MonotonicTime ended = clock_->now();
  rests_until_ = std::max(rests_until_, ended + kRests * (ended - begun));
}

}  // namespace thimble::app
