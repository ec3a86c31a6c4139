#include "daemon/coupling/two_port_world.hpp"

#include <algorithm>

namespace thimble::coupling {

Result<void> TwoPortWorld::open(const HandSample& first) {
  if (Result<void> opened = inside_->open(first); !opened) return opened;
  account_.reset();
  account_.hear(first.energy_joule);
  place_ = first.hand;
  told_ = {};
  newest_ = 0;
  return {};
}

ConstraintSet TwoPortWorld::answer(const HandSample& sample, Duration dt) noexcept {
  const bool is_usable = is_finite(sample.hand) && is_finite(sample.velocity);
  if (!is_usable || sample.sequence <= newest_) {
    ConstraintSet set = inside_->answer(sample, dt);
    set.energy_joule = account_.put_in_joule();
    return set;
  }
  newest_ = sample.sequence;
  account_.hear(sample.energy_joule);
  const HandSample taken = sample.energy_joule >= 0 ? held_back(sample) : sample;
  ConstraintSet set = inside_->answer(taken, dt);
  const bool has_force = set.has_far && is_finite(set.far.force);
  const Force3 force = has_force ? set.far.force : Force3{};
  const Displacement3 moved = taken.hand - place_;
  const double before_joule = -dot(told_, moved);
  const double after_joule = -dot(force, moved);
  account_.take_out(std::max(before_joule, after_joule));
  account_.put_in(std::min(-before_joule, -after_joule));
  place_ = taken.hand;
  told_ = force;
  set.energy_joule = account_.put_in_joule();
  return set;
}

HandSample TwoPortWorld::held_back(const HandSample& sample) const noexcept {
  HandSample taken = sample;
  const Displacement3 moved = sample.hand - place_;
  const double wanted_joule = -dot(told_, moved);
  if (!(wanted_joule > account_.left_joule())) return taken;
  const double share = account_.left_joule() / wanted_joule;
  taken.hand = place_ + share * moved;
  taken.velocity = share * sample.velocity;
  return taken;
}

}  // namespace thimble::coupling
