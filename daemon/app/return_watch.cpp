#include "daemon/app/return_watch.hpp"

#include <utility>

#include "hal/device/fault.hpp"

namespace thimble::app {

ReturnWatch::Change ReturnWatch::note(std::size_t arm, OperatingState state) {
  if (arm >= seen_.size()) seen_.resize(arm + 1, Seen::Never);
  const Seen now = state == OperatingState::Lost ? Seen::Lost : Seen::There;
  const Seen before = std::exchange(seen_[arm], now);
  if (before == Seen::There && now == Seen::Lost) return Change::Left;
  if (before == Seen::Lost && now == Seen::There) return Change::Returned;
  return Change::None;
}

void ReturnWatch::forget(std::size_t arm) {
  if (arm < seen_.size()) seen_[arm] = Seen::Never;
}

std::string sentence_of(const config::ArmConfig& arm, ReturnWatch::Change change) {
  if (change == ReturnWatch::Change::Returned) {
    return "arm '" + arm.name + "': " + arm.device + " is there again";
  }
  return "arm '" + arm.name + "' stopped: " + std::string(explain(FaultCode::Disconnected));
}

}  // namespace thimble::app
