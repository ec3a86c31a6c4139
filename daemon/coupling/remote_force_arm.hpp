#pragma once

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/far_end_port.hpp"

namespace thimble::coupling {

// Thesis 3.2 says no numbers; the wall is the ghost point's, its damping is not: where it comes
// late it drives instead of damping (teleop.md 2(a), decision 0420).
struct RemoteForceSettings {
  ToolProperties tool{.stiffness = {800}, .damping = {0}};
  ConstraintAgeSettings age{};
};

// The arm half of the remote closed loop ("Hello, sphere", thesis 3.2): shows the newest force that
// the world half computed (RemoteForceWorld), and holds it until the next.
//
//   F(t) = −K·x(t−D) − B·v(t−D) where x(t−D) > 0, else 0
//
// F  force on the hand, N        D   from sample to answer, there and back, s
// x  penetration of a wall, m    K, B  of the wall: N/m, N·s/m
//
// Limits (Gil, Diolaiti, Hulin: docs/references.md; teleop.md 2(a)): with a hand of damping b,
// N·s/m, and a servo period Ts it is stable for K < (b + B)/(Ts/2 + D), short D (and passive, where
// D is 0, for b > K·Ts/2 + |B|, Colgate and Schenkel); beyond that it swings, and only the limiter
// bounds it. To be shown and compared with.
//
// What the hand feels of a silent world, an outage, a restart: FarEndPort.
// Thread: one servo thread. RT: reset(), step() THIMBLE_RT.
// Frames: base frame of the arm, which is the world's, axes parallel; no offset.
// Errors: FarEndPort's.
class RemoteForceArm final : public ArmCoupling {
 public:
  explicit RemoteForceArm(const RemoteForceSettings& settings = {}) noexcept;

  [[nodiscard]] const FarEndPort& port() const noexcept { return port_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  ToolProperties tool_;
  FarEndPort port_;
  Force3 force_{};
  bool is_pressing_{false};
};

}  // namespace thimble::coupling
