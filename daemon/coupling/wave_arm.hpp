#pragma once

#include <atomic>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/far_end_port.hpp"
#include "daemon/coupling/wave_channel.hpp"

namespace thimble::coupling {

struct WaveSettings {
  // b: heavy and hard to light and soft; between the extremes at 50 ms one way (teleop.md 3).
  Damping impedance{10};
  // 1/λ of the wave filter: filter_share of the one-way delay (teleop.md 2(c): half to all of it),
  // of the longest since reset(); at least `filter`, which is what b = 40 takes on a bus that
  // answers 2 ms late: without it 20 hold (decision 0422).
  Duration filter{std::chrono::milliseconds(5)};
  double filter_share{0.5};
  // e-fold of b in this time, when it is tuned. Ours: from 2 to 40 in 0.75 s, before a person tries
  // the tool; slow beside the filter.
  Duration tuning_time{std::chrono::milliseconds(250)};
  ConstraintAgeSettings age{};
};

// The arm half of wave-based teleoperation (thesis 3.5): hand and slave (WaveWorld) exchange waves,
// of which any constant delay is passive. SOURCE: Niemeyer and Slotine (docs/references.md), as
// derived in teleop.md 2(c).
//
//   F_m = b·v − √(2b)·w       u = √(2b)·v − w       power F_m·v = u²/2 − w²/2
//
// F_m  what the hand puts in, N; −F_m is felt    b  wave impedance, N·s/m
// v    of the hand, m/s                          u  wave to the world, √W
// w    wave from it, √W, filtered: w' = λ·(w_in − w), of gain <= 1, so passive, too
//
// The filter is the thesis's wave filter and wave controller (teleop.md 2(c) has them as one); its
// impedance matching is the slave's B_s = b (WaveWorld).
//
// Shown (teleop.md 2(c)): in free space a mass b·T beside the slave's, in contact a stiffness b/T
// in series with slave and wall, before the first answer a damper b. T: one way and half the
// filter, s. Delay, jitter, loss and order: WaveOutlet. No drift: what is sent is the distance, not
// only its speed, and v is the filtered speed drawn to where the tip is (kKeepUp).
//
// b may be tuned while it runs: set_impedance(), from any one thread; it slides.
//
// What the hand feels of a silent world, an outage, a restart: FarEndPort; of a gap, a damper b.
// Thread: one servo thread. RT: reset(), step() THIMBLE_RT. Frames: base frame of the arm, which is
// the world's, axes parallel; no offset. Errors: FarEndPort's; sums that are older are ignored.
class WaveArm final : public ArmCoupling {
 public:
  explicit WaveArm(const WaveSettings& settings = {}) noexcept;

  // kLeastImpedance to kMostImpedance; what is not finite is left alone.
  bool set_impedance(Damping b) noexcept override;
  // As it is now; servo thread.
  [[nodiscard]] Damping impedance() const noexcept { return {b_newton_s_per_m_}; }
  [[nodiscard]] const FarEndPort& port() const noexcept { return port_; }
  [[nodiscard]] const WaveSums& sent() const noexcept { return to_world_.sums(); }
  [[nodiscard]] const WaveOutlet& incoming() const noexcept { return from_world_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  void tune(double dt_s) noexcept;
  void lengthen_filter(Duration round_trip) noexcept;
  [[nodiscard]] Velocity3 velocity_of(const ArmInput& input) noexcept;

  WaveSettings settings_;
  std::atomic<double> wanted_b_newton_s_per_m_;
  static_assert(std::atomic<double>::is_always_lock_free);
  double b_newton_s_per_m_;
  FarEndPort port_;
  WaveInlet to_world_{};
  WaveOutlet from_world_{};
  Wave3 filtered_{};
  double filter_s_;       // 1/λ
  Impulse3 impulse_{};    // P: P' = F_m − P/kImpulseMemory_s
  Position3 sent_tip_{};  // where the waves say that the tip is; what a slave starts from
  bool is_pressing_{false};
};

}  // namespace thimble::coupling
