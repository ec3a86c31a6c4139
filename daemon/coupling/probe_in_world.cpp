#include "daemon/coupling/probe_in_world.hpp"

#include <algorithm>
#include <utility>

namespace thimble::coupling {

Result<void> ProbeInWorld::open(const HandSample& first) {
  if (!is_finite(first.hand)) return fail(Errc::InvalidArgument, "hand position is not finite");
  close();
  const Result<world::ProbeId> probe = world_.add_probe(first.hand);
  if (!probe) return tl::unexpected<Error>(probe.error());
  probe_ = *probe;
  newest_ = first.sequence;
  buttons_ = first.buttons;
  told_ = first.presses;
  asked_ = first.actions;
  return {};
}

void ProbeInWorld::hear(const HandSample& sample) noexcept {
  if (sample.sequence < newest_) return;  // its counts are older: the way on from there is 255 long
  newest_ = sample.sequence;
  press(sample);
  ask(sample);
}

void ProbeInWorld::press(const HandSample& sample) noexcept {
  constexpr std::uint32_t kCounted = 0xFF;  // the buttons of PressCounts
  const std::uint32_t before = std::exchange(buttons_, sample.buttons);
  std::uint32_t pressed = sample.buttons & ~before;
  if (!sample.has_presses) return world_.press(*probe_, pressed);
  pressed &= ~kCounted;
  for (int round = 0; round < kMostPresses; ++round) {
    for (std::size_t i = 0; i < told_.size(); ++i) {
      if (told_[i] == sample.presses[i]) continue;
      ++told_[i];
      pressed |= 1U << i;
    }
    if (round > 0 && pressed == 0) return;
    world_.press(*probe_, std::exchange(pressed, 0));
  }
}

void ProbeInWorld::ask(const HandSample& sample) noexcept {
  if (!sample.has_actions) return;
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (asked_[i] == sample.actions[i]) continue;
    if (world_.act(*probe_, static_cast<world::HandAction>(i))) ++asked_[i];
  }
}

world::ProbeMotion ProbeInWorld::move(Position3 at, Duration dt) noexcept {
  return world_.move_probe(*probe_, at, std::max(dt, Duration(1)));
}

void ProbeInWorld::close() noexcept {
  if (!probe_) return;
  world_.remove_probe(*probe_);
  probe_.reset();
}

}  // namespace thimble::coupling
