#include "daemon/app/lateness_watch.hpp"

namespace thimble::app {

bool is_worth_telling(std::uint64_t missed, Duration period) noexcept {
  constexpr double kTold_s = 1e-3;
  return static_cast<double>(missed) * seconds(period) >= kTold_s;
}

void LatenessWatch::note(std::size_t arm, MonotonicTime now, std::uint64_t overruns) {
  if (arm >= arms_.size()) arms_.resize(arm + 1);
  Arm& watched = arms_[arm];
  if (overruns < watched.overruns) watched = {{}, overruns};  // another servo began to count
  if (overruns > watched.overruns) {
    watched.changes.push_back({now, watched.overruns});
    watched.overruns = overruns;
  }
  while (!watched.changes.empty() && now - watched.changes.front().at > kWindow) {
    watched.changes.pop_front();
  }
}

std::uint64_t LatenessWatch::missed_lately(std::size_t arm) const {
  if (arm >= arms_.size() || arms_[arm].changes.empty()) return 0;
  return arms_[arm].overruns - arms_[arm].changes.front().overruns;
}

}  // namespace thimble::app
