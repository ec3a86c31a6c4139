#include "lab/trial/pair_loop.hpp"

#include <utility>

namespace thimble::lab {

PairLoop::PairLoop(Arm first, Arm second, Duration dt)
    : arms_{std::move(first), std::move(second)}, dt_(dt) {
  using Side = coupling::ArmPair::Side;
  const coupling::ArmPair pair(1);
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    far_ends_[i] = pair.make_half(i == 0 ? Side::First : Side::Second, arms_[i].answer);
    links_[i].emplace(link::InProcessLink::Settings{.impairment = arms_[i].impairment},
                      *far_ends_[i]);
  }
}

std::array<coupling::ArmOutput, 2> PairLoop::tick(const std::array<Seen, 2>& seen) {
  if (std::exchange(is_first_, false)) {
    for (std::size_t i = 0; i < 2; ++i) arms_[i].half->reset(now_, seen[i].tip);
  }
  run_links_until(now_ + dt_);
  now_ = now_ + dt_;
  std::array<coupling::ArmOutput, 2> out{};
  for (std::size_t i = 0; i < 2; ++i) {
    coupling::ArmLink& link = links_[i]->arm_end();
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
    (void)links_[i]->pump(now_);
  }
  return out;
}

// What is due on either link, in the order of time.
void PairLoop::run_links_until(MonotonicTime end) {
  MonotonicTime at = now_;
  while (at < end) {
    MonotonicTime next = end;
    for (auto& link : links_) {
      const auto due = link->pump(at);
      if (due && *due > at && *due < next) next = *due;
    }
    at = next;
  }
  for (auto& link : links_) (void)link->pump(end);
}

}  // namespace thimble::lab
