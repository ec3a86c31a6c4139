#include "daemon/coupling/constraint_age.hpp"

#include <algorithm>

namespace thimble::coupling {
namespace {

constexpr int kRoundTrips = 3;  // DESIGN section 4

}  // namespace

void ConstraintAge::restart(MonotonicTime now) noexcept {
  last_reply_ = now;
  gain_ = 1;
  is_frozen_ = false;
  is_fading_ = false;
  has_returned_ = false;
}

void ConstraintAge::update(const ArmInput& input) noexcept {
  has_returned_ = is_fading_ && input.fresh != nullptr;
  if (input.fresh != nullptr) last_reply_ = input.now;

  const Duration age = input.now - last_reply_;
  const Duration patience = kRoundTrips * std::max(input.link.round_trip, Duration::zero());
  is_frozen_ = age > std::max(settings_.freeze_floor, patience);
  is_fading_ = age > std::max(settings_.fade_floor, patience + input.link.jitter);

  const double fade_s = seconds(settings_.fade_time);
  const double share = fade_s > 0 ? seconds(input.dt) / fade_s : 1;
  gain_ = std::clamp(is_fading_ ? gain_ - share : gain_ + share, 0.0, 1.0);
}

}  // namespace thimble::coupling
