#pragma once

#include "daemon/coupling/scheme.hpp"

// What is bounded before a wall that moves, and where theory says that it need not be. SI. Pure.
// Errors: none. SOURCE of the theory: teleop.md 2; its use here: decision 0465.
namespace thimble::lab {

// A finger that is held there behind the wall's face while its front goes to and fro.
inline constexpr double kHeldBehind_m = 0.020;

// What came of it, once it is as it stays.
struct HeldAtWall {
  double swing_before_m{0};  // peak to peak, for some periods of the wall
  double swing_last_m{0};    // as long again, right behind
  double most_newton{0};     // in both
  double last_newton{0};     // mean of the last, against the hand: what is left of the wall
  double given_joule{0};     // to the hand, in a period of the last; the wall's work is within
};

// Ours: by how much a swing may be larger than the one before and be no growth; jitter and losses
// are not the same again. A hand that is still moves by less than kGrows_m: G1 of ranking.hpp.
inline constexpr double kGrowsTo_ratio = 1.1;
inline constexpr double kGrows_m = 0.0005;

// Most that the wall puts into the hand in a period: once it comes forward by a cell, s, against a
// hand that presses it with F, and puts F·s + ½·K·s² into the spring between them. F: that of the
// hand undelayed, K·k/(K + k)·kHeldBehind_m, k the finger's own.
[[nodiscard]] double wall_work_joule() noexcept;

// It swings no more than before, is given no more than the wall puts in, and asks for no more than
// an arm gives, where what grows comes to an end. What is not a number is not bounded.
[[nodiscard]] bool is_bounded(const HeldAtWall& held) noexcept;

// A hand with a damper of its own, at what takes out no less than it gives, comes to a bound
// whatever bounded thing the wall does, so that nothing may grow which is passive at any delay: a
// spring and damper that softens (2(b)), waves (2(c)), and walls that are rendered at the arm
// (2(d), 2(e)), which K·Ts/2 < b alone limits. The remote closed loop (2(a)) has no such bound
// beyond K = b·ω/sin(ω·τ) (stability/theory.hpp). `late_s`: how old its force becomes, there and
// back, not only once in a while.
[[nodiscard]] bool may_grow(coupling::Scheme scheme, double late_s) noexcept;

// Where the wall stays: whom theory lets give the hand energy, or ask for more than an arm gives.
// The remote closed loop; and a spring and damper through a silence of the network: its K_c is held
// below B/T of the delay that it measures, and a silence is none. A hand at v has stretched it by
// v·kOutage_s when the first sample comes through: 16 N at 0.1 m/s and 800 N/m (decision 0477).
[[nodiscard]] bool may_give(coupling::Scheme scheme, bool has_outages) noexcept;
// Of force alone, on any network: the scenario of the outage has a silence on each.
[[nodiscard]] bool may_ask_for_more(coupling::Scheme scheme) noexcept;

}  // namespace thimble::lab
