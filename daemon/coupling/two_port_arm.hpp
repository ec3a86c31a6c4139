#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/port_account.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// The arm's end of a passivity guard between both ends (time-domain passivity with delay, Ryu,
// Artigas and Preusche 2010, docs/references.md), around an arm half whose force is computed in the
// world. No more comes out at the hand than was put in at the world's port, one way ago:
//
//   E_out,M(k) <= E_in,S(k − D₂) + E_0         the world's end: TwoPortWorld
//   α(k)  = min(F·v, (F·v·dt − left)/dt)/|v|²   where F·v·dt > left and |v| >= v_min, else 0
//   F'(k) = F(k) − α·v(k)
//
// F     of the arm half inside, N          p, v  of the tip, m and m/s: v as the servo filters it
// left  of the account (port_account.hpp), J, by the work F'(j)·(p(j+1) − p(j)), j < k
// E_0   PassivitySettings::bound_joule     v_min least_m_per_s; D₂ from world to arm, s
//
// What is withheld is never more than what pushes along the motion, so that it needs no cap and the
// hand is given no more than by the bare scheme in any step, whatever the world tells: energies are
// not believed beyond PortAccount's credit, and one that tells none only has more withheld. A world
// that tells too much gets the bare scheme at worst.
//
// Where v tells the next move of the tip rightly and |v| >= v_min the first line holds always; else
// what came out too much is missing afterwards. Unlike PassivityGuard it lets a world push that
// moves by itself, as far as it says so; and it withholds for D after a hand turns back from a
// wall, as the energy that the wall returns is not yet told.
//
// The energy is that of forces as wished here, before the limiter. What is not finite passes on, to
// the limiter, which latches it; no energy is counted of it.
//
// Thread: as the arm half inside. RT: reset(), step() THIMBLE_RT. Ownership: of what is inside.
// Frame: base frame of the arm. Errors: none but those of what is inside.
class TwoPortArm final : public ArmCoupling {
 public:
  TwoPortArm(std::unique_ptr<ArmCoupling> inside, const PassivitySettings& settings) noexcept
      : inside_(std::move(inside)),
        least_m_per_s_(settings.least_m_per_s),
        account_(settings.bound_joule, settings.credit_joule) {}

  bool set_impedance(Damping b) noexcept override { return inside_->set_impedance(b); }
  // Since construction.
  [[nodiscard]] std::uint64_t steps_withheld() const noexcept { return steps_withheld_; }
  [[nodiscard]] const ArmCoupling& inside() const noexcept { return *inside_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;
  void hear(const ConstraintSet& said) noexcept;
  [[nodiscard]] double withheld_newton_s_per_m(Force3 force, const ArmInput& input) const noexcept;

  std::unique_ptr<ArmCoupling> inside_;
  double least_m_per_s_;
  PortAccount account_;
  std::uint32_t session_{0};
  std::uint64_t steps_withheld_{0};
};

}  // namespace thimble::coupling
