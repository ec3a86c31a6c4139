#pragma once

#include "daemon/coupling/messages.hpp"
#include "daemon/coupling/probe_in_world.hpp"
#include "daemon/coupling/wall_penalty.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::coupling {

// The mass that follows a hand through a world, and the walls that it meets there. As teleop.md
// 2(b) and 3 have them in their figures.
struct SlaveSettings {
  double mass_kg{0.1};
  ToolProperties wall{.stiffness = {800}, .damping = {10}};  // of a wall that names none
};

// A teleoperator's slave (thesis 3.4): a point mass that a controller pulls and the walls of the
// world push, wall_penalty(). m·dv/dt = F_controller + F_walls, semi-implicit Euler in steps of at
// most kStep; the probe goes along once in kProbePace of the world's time, however samples come.
//
// Stable for (K·h² + 2·B·h)/m < 4, h a step, K and B of controller and walls together: 1.1 with
// kHardestController at a wall of kHardestTool.
//
// Thread: the world's. Not RT; neither allocates nor blocks where move_probe() does not.
// Ownership: the world must outlive it; the destructor closes the probe. Frame: world.
// Errors: open() refuses a hand that is not finite, and passes on what the world says; advance()
//         says false where the world is silent.
class Slave {
 public:
  // Ours: a quarter of kProbePace, which is too long for the hardest (4.5); the rest is for walls
  // that meet.
  static constexpr Duration kStep = std::chrono::microseconds(250);
  // Ours: as often as a servo of 1 kHz (teleop.md 1) moves the probe of a scheme without a slave.
  static constexpr Duration kProbePace = std::chrono::milliseconds(1);

  Slave(world::World& world, const SlaveSettings& settings) noexcept
      : probe_(world), settings_(settings) {}

  // At rest, where the hand is.
  [[nodiscard]] Result<void> open(const HandSample& first);
  [[nodiscard]] bool is_open() const noexcept { return probe_.is_open(); }
  void close() noexcept { probe_.close(); }
  void hear(const HandSample& sample) noexcept { probe_.hear(sample); }

  // Lets `dt` pass. `pull(at, velocity, step)` is asked for the controller's force, N, before each
  // step of that many seconds. False when the world could not say what is there: time stood still
  // for the slave from there on, and it rests.
  template <class Pull>
  bool advance(Duration dt, const Pull& pull) noexcept {
    while (dt > Duration::zero()) {
      const Duration stretch = std::min(dt, kProbePace);
      if (!look_around(stretch)) return false;
      const auto steps = (stretch + kStep - Duration(1)) / kStep;
      const double step_s = seconds(stretch) / static_cast<double>(steps);
      for (auto i = steps; i > 0; --i) move(pull(at_, velocity_, step_s), step_s);
      dt -= stretch;
    }
    return true;
  }

  [[nodiscard]] Position3 at() const noexcept { return at_; }
  [[nodiscard]] Velocity3 velocity() const noexcept { return velocity_; }
  // Of the walls on the slave, N, now.
  [[nodiscard]] Force3 wall_force() const noexcept {
    return wall_penalty(planes_, settings_.wall, at_, velocity_);
  }
  // Makes `set` the next reply of its session: where the slave and its probe are.
  void tell(const HandSample& sample, ConstraintSet& set) const noexcept;

 private:
  bool look_around(Duration dt) noexcept;
  void move(Force3 pull, double step_s) noexcept;

  ProbeInWorld probe_;
  SlaveSettings settings_;
  world::ProbeMotion around_{};
  PlaneList planes_{};
  Position3 at_{};
  Velocity3 velocity_{};
};

// Of a controller that pulls a slave. K: kHardestTool's. B, ours: what 800 N/m ask for (B > K_c·T,
// teleop.md 2(b)) at 500 ms there and back, the longest delay of table 4.1.
inline constexpr ToolProperties kHardestController{.stiffness = {3000}, .damping = {200}};

}  // namespace thimble::coupling
