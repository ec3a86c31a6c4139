#pragma once

#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// What a wave channel takes for b, N·s/m: below, nothing is felt; above, a servo of 500 Hz and a
// PHANToM's velocity of 2 ms ago no longer hold it.
inline constexpr double kLeastImpedance_newton_s_per_m = 0.1;
inline constexpr double kMostImpedance_newton_s_per_m = 40;

// How long either end remembers an impulse (WaveWorld, place), s. Ours: longer than a touch's
// flight, or the slave would be drawn off its lead; shorter than a person waits for a tool that was
// tuned.
inline constexpr double kImpulseMemory_s = 1.5;

// Where a wave enters a channel: adds up what is sent (WaveSums).
// Thread: one. RT: THIMBLE_RT. Errors: none; finite in, finite out.
class WaveInlet {
 public:
  THIMBLE_RT void restart() noexcept { sums_ = {}; }
  // `wave` for `dt_s` > 0 seconds.
  THIMBLE_RT void send(Wave3 wave, double dt_s) noexcept;
  [[nodiscard]] const WaveSums& sums() const noexcept { return sums_; }

 private:
  WaveSums sums_{};
};

// Where it leaves, after any delay, loss, doubling or change of order: an energy reservoir
// (Niemeyer and Slotine 1998, docs/references.md, had the thought; the formula is derived in
// teleop.md 2(c), ii). Per axis, with U and E of what has arrived and of what was given out:
//
//   u = 2·(E_in − E_out)/(U_in − U_out),  |u| <= |U_in − U_out|/dt,  0 where the U are equal
//
// the constant wave that covers the missing distance with exactly the energy there is. So E_out <=
// E_in always, U_out comes to U_in, and what is lost or overtaken is only late. Energy that is left
// when the distance is covered, as of a wave that went to and fro while nothing came, is
// dissipated: it would let a later distance be covered by a blow.
//
// A gap makes the channel that much longer until the wave has been at rest.
//
// Thread: one. RT: THIMBLE_RT. Errors: none; sums that are older than those known are ignored.
class WaveOutlet {
 public:
  // What was sent before `before` is not given out.
  THIMBLE_RT void restart(const WaveSums& before = {}) noexcept;
  THIMBLE_RT void deliver(const WaveSums& newest) noexcept;
  // The wave for the next `dt_s` > 0 seconds.
  [[nodiscard]] THIMBLE_RT Wave3 take(double dt_s) noexcept;

  [[nodiscard]] const WaveSums& delivered() const noexcept { return in_; }
  // Given out or dissipated.
  [[nodiscard]] const WaveSums& taken() const noexcept { return out_; }

 private:
  WaveSums in_{};
  WaveSums out_{};
};

}  // namespace thimble::coupling
