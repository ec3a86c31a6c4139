#include "lab/trial/pair_loop.hpp"

#include <utility>

namespace thimble::lab {

PairLoop::PairLoop(Arm first, Arm second, Duration dt)
    : arms_{std::move(first), std::move(second)}, dt_(dt) {
  using Side = coupling::ArmPair::Side;
  const coupling::ArmPair pair(1);
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    if (i == 1 && arms_[i].guest) {
      invite(pair);
      continue;
    }
    far_ends_[i] = pair.make_half(i == 0 ? Side::First : Side::Second, arms_[i].answer);
    links_[i].emplace(link::InProcessLink::Settings{.impairment = arms_[i].impairment},
                      *far_ends_[i]);
  }
}

// As session::ArmHost has it.
void PairLoop::invite(const coupling::ArmPair& pair) {
  DatagramLink::Settings settings = *arms_[1].guest;
  settings.arm.impairment = arms_[1].impairment;
  if (!settings.world.arm_scheme) settings.world.arm_scheme = settings.arm.half.scheme;
  settings.world.max_sessions = 1;
  guest_.emplace(settings,
                 [pair, answer = arms_[1].answer](
                     const link::ThimbleHalf&) -> Result<std::unique_ptr<coupling::WorldCoupling>> {
                   return pair.make_half(coupling::ArmPair::Side::Second, answer);
                 });
}

void PairLoop::restart_guest(std::unique_ptr<coupling::ArmCoupling> half, Position3 tip) {
  arms_[1].half = std::move(half);
  arms_[1].half->reset(now_, tip);
  link::ThimbleArmEnd::Settings settings = arms_[1].guest->arm;
  settings.impairment = arms_[1].impairment;
  guest_->restart_arm(settings);
}

std::array<coupling::ArmOutput, 2> PairLoop::tick(const std::array<Seen, 2>& seen) {
  if (std::exchange(is_first_, false)) {
    for (std::size_t i = 0; i < 2; ++i) arms_[i].half->reset(now_, seen[i].tip);
  }
  run_links_until(now_ + dt_);
  now_ = now_ + dt_;
  std::array<coupling::ArmOutput, 2> out{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!is_up[i]) continue;
    coupling::ArmLink& link = end_of(i);
    coupling::ConstraintSet reply;
    const bool is_fresh = link.receive(reply);
    out[i] = arms_[i].half->step({.now = now_,
                                  .dt = dt_,
                                  .tip = seen[i].tip,
                                  .tip_velocity = seen[i].velocity,
                                  .buttons = 0,
                                  .fresh = is_fresh ? &reply : nullptr,
                                  .link = link.quality()});
    link.send(out[i].sample);
    (void)pump(i, now_);
  }
  return out;
}

// What is due on either link, in the order of time.
void PairLoop::run_links_until(MonotonicTime end) {
  MonotonicTime at = now_;
  while (at < end) {
    MonotonicTime next = end;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto due = pump(i, at);
      if (due && *due > at && *due < next) next = *due;
    }
    at = next;
  }
  for (std::size_t i = 0; i < 2; ++i) (void)pump(i, end);
}

}  // namespace thimble::lab
