#pragma once

#include "daemon/coupling/energy_observer.hpp"
#include "daemon/servo/velocity_filter.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"

namespace thimble::lab {

// SOURCE: teleop.md sections 3 and 4 (H2).
struct FingerSettings {
  double mass_kg{0.15};
  double stiffness_newton_per_m{200};
  double damping_newton_s_per_m{4};
  double friction_newton{0.04};  // Coulomb's, of the arm
  double most_newton{8.5};       // what the arm gives along an axis
  double reach_m{0.0635};        // of the arm, to either side: teleop.md 1
};

// Where the person wants the finger.
struct FingerGoal {
  Position3 at{};
  Velocity3 moving{};
  // Instead of drawing the finger to `at` along x, the hand pushes with this, N.
  double push_newton{0};
  bool is_pushing{false};
};

// A person's finger in an ideal arm: a mass, drawn by a spring and a damper to where the person
// wants it, the same along each axis. The plant runs 20 times as fast as the servo. Base frame, SI.
//
// Thread: one. Errors: none.
class Finger {
 public:
  explicit Finger(Position3 start, Duration dt, const FingerSettings& settings = {});

  // One tick of the servo, under the force that it commands.
  void move(const FingerGoal& goal, Force3 commanded);

  [[nodiscard]] Position3 tip() const noexcept { return tip_; }
  // As the servo has it: filtered.
  [[nodiscard]] Velocity3 seen_velocity() const noexcept { return filter_.velocity(); }
  // Work done on the finger by what was commanded, as the arm gives it.
  [[nodiscard]] const coupling::EnergyObserver& energy() const noexcept { return energy_; }

 private:
  void step(const FingerGoal& goal, Force3 given, Duration dt) noexcept;

  FingerSettings settings_;
  Duration dt_;
  MonotonicTime now_{};
  Position3 tip_;
  Velocity3 velocity_{};
  servo::VelocityFilter filter_{};
  coupling::EnergyObserver energy_{};
};

}  // namespace thimble::lab
