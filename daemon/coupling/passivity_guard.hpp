#pragma once

#include <cstdint>
#include <memory>

#include "daemon/coupling/arm_coupling.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Sources: Hannaford and Ryu (docs/references.md), and a program in production, sai-primitives'
// POPCBilateralTeleoperation.cpp (teleop.md, "TDPA"); what is ours says so.
struct PassivitySettings {
  // What the hand may be given on balance before the guard acts, J. Ours: what one shift of the
  // ghost point's frame gives is 0.1 mJ (teleop.md 2(e)); a few of them at once are not noise.
  double bound_joule{0.001};
  // The most damping that is added, N·s/m. The production program takes 0.9 of what the device
  // bears; of the arms we know the weakest bears 5 (teleop.md 1).
  Damping most{4.5};
  // Below it there is no telling which way the hand moves, m/s: the production program's 1e-4
  // m²/s².
  double least_m_per_s{0.01};
  // Of what the hand gave, so much may come back, J. Ours: more than any wall stores within the 8.5
  // N of the strongest arm (50 N/m: 0.7 J).
  double credit_joule{1};
};

// A guard for any arm half: a time-domain passivity observer and controller at the port of the hand
// (Hannaford and Ryu 2002; one port, impedance causality), around the arm half that it owns.
//
//   E(k) = Σ F'(j)·(p(j+1) − p(j)),  j < k             given to the hand on balance, J
//   W    = E(k) + F(k)·v(k)·dt(k)                       what it will be after this step
//   α(k) = min(α_max, (W − E_0)/(|v|²·dt))  where W > E_0 and |v| >= v_min, else 0
//   F'(k) = F(k) − α·v(k)
//
// F     of the arm half inside, N        p, v  of the tip, m and m/s: v as the servo filters it
// E_0   bound_joule                      α     added damping, N·s/m; α_max, v_min as configured
//
// While W <= E_0 not a bit of F is changed. What is added acts against the motion: at the motion
// that the servo sees, the hand gets no more than without the guard in any step. Where v tells the
// next move of the tip rightly, |v| >= v_min and α_max is not reached, E <= E_0 always; else E
// exceeds it by what the steps gave that could not be held, and the next ones take it back. What is
// done is measured by places, so that no error of v adds up.
//
// What the hand put into the arm half it may get back: a spring. But not more than `credit_joule`
// of it, lest a drag of minutes pays for a blow.
//
// The energy is that of forces as wished here, before the limiter, and of places as the device told
// them: what it does within its own latency is not seen. What is not finite passes on, to the
// limiter, which latches it; no energy is counted of it.
//
// Thread: as the arm half inside. RT: reset(), step() THIMBLE_RT. Ownership: of what is inside.
// Frame: base frame of the arm. Errors: none but those of what is inside. reset() forgets the
// balance.
class PassivityGuard final : public ArmCoupling {
 public:
  PassivityGuard(std::unique_ptr<ArmCoupling> inside, const PassivitySettings& settings) noexcept
      : inside_(std::move(inside)), settings_(settings) {}

  bool set_impedance(Damping b) noexcept override { return inside_->set_impedance(b); }

  // E: above 0, the hand has been given more than it gave. energy() has it without the credit.
  [[nodiscard]] double given_joule() const noexcept { return given_joule_; }
  // Since construction: steps in which damping was added, and those in which it was all there is.
  [[nodiscard]] std::uint64_t steps_damped() const noexcept { return steps_damped_; }
  [[nodiscard]] std::uint64_t steps_at_most() const noexcept { return steps_at_most_; }
  [[nodiscard]] const ArmCoupling& inside() const noexcept { return *inside_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  [[nodiscard]] double damping_newton_s_per_m(Force3 force, const ArmInput& input) const noexcept;

  std::unique_ptr<ArmCoupling> inside_;
  PassivitySettings settings_;
  double given_joule_{0};
  std::uint64_t steps_damped_{0};
  std::uint64_t steps_at_most_{0};
};

}  // namespace thimble::coupling
