#pragma once

#include <algorithm>

#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// The energy at one end of a two-port, split by the sign of its power, beside what was put in at
// the other end (time-domain passivity with delay, Ryu, Artigas and Preusche 2010; teleop.md,
// "TDPA"):
//
//   E_in  = Σ max(0, −W)   put in here, told to the other end    W  work of a step that came out
//   E_out = Σ max(0, W)    came out here                            here, J; below 0 it was put in
//   left  = E_0 + E_told − E_out                                 E_0  bound
//
// E_told is E_in of the other end as its newest message has it. It only grows: of several messages
// the newest says all that the others did, so that delay, loss and disorder only lower `left`. What
// is left is never more than `credit`, lest a drag of minutes pays for a blow (PassivityGuard).
//
// Errors: an E_told that is not finite, negative, above 1e9 J or less than known is as good as
// none. Thread: one. RT: THIMBLE_RT. Units: J.
class PortAccount {
 public:
  PortAccount(double bound_joule, double credit_joule) noexcept
      : bound_joule_(bound_joule), credit_joule_(credit_joule), left_joule_(bound_joule) {}

  THIMBLE_RT void reset() noexcept { *this = PortAccount(bound_joule_, credit_joule_); }
  // The other end began anew: what it tells next is where it counts from. Nothing is won by it.
  THIMBLE_RT void forget_other_end() noexcept {
    has_heard_ = false;
    left_joule_ = std::min(left_joule_, bound_joule_);
  }
  THIMBLE_RT void hear(double told_joule) noexcept {
    constexpr double kAbsurd_joule = 1e9;  // ours: as in far_end_port.cpp, no sum of hours
    if (!(told_joule >= 0) || told_joule > kAbsurd_joule) return;
    const double gain_joule = has_heard_ ? told_joule - told_joule_ : 0;
    if (gain_joule < 0) return;
    has_heard_ = true;
    told_joule_ = told_joule;
    left_joule_ = std::min(left_joule_ + gain_joule, credit_joule_);
  }
  THIMBLE_RT void put_in(double work_joule) noexcept { put_in_joule_ += std::max(0.0, work_joule); }
  THIMBLE_RT void take_out(double work_joule) noexcept { left_joule_ -= std::max(0.0, work_joule); }

  // E_in.
  [[nodiscard]] THIMBLE_RT double put_in_joule() const noexcept { return put_in_joule_; }
  // What may come out; >= 0 also where more came out than could be held back.
  [[nodiscard]] THIMBLE_RT double left_joule() const noexcept { return std::max(0.0, left_joule_); }

 private:
  double bound_joule_;
  double credit_joule_;
  double left_joule_;
  double put_in_joule_{0};
  double told_joule_{0};
  bool has_heard_{false};
};

}  // namespace thimble::coupling
