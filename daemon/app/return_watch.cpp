#include "daemon/app/return_watch.hpp"

namespace thimble::app {

bool ReturnWatch::note(std::size_t arm, OperatingState state) {
  if (arm >= were_lost_.size()) were_lost_.resize(arm + 1);
  const bool was_lost = were_lost_[arm];
  were_lost_[arm] = state == OperatingState::Lost;
  return was_lost && !were_lost_[arm];
}

void ReturnWatch::forget(std::size_t arm) {
  if (arm < were_lost_.size()) were_lost_[arm] = false;
}

}  // namespace thimble::app
