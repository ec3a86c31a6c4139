#pragma once

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/far_end_port.hpp"
#include "daemon/coupling/spring_damper.hpp"

namespace thimble::coupling {

struct SpringDamperSettings {
  // K_c as hard as the ghost point's wall, B as a PHANToM takes it (teleop.md 1).
  ToolProperties tool{.stiffness = {800}, .damping = {5}};
  ForceAt force_at{ForceAt::World};
  // The far end is another arm (arm_pair.hpp): T is a whole round trip of this arm's link, and K_c
  // no larger than the other arm's. One that has no spring (GhostPointArm) lets K_c be. Where it is
  // not known in advance what the far end says counts (FarEnd::is_arm), as on another host: then B
  // is the smaller of both, and K_c begins anew with each epoch, for it may be another arm.
  bool is_between_arms{false};
  // Whether K_c falls with delay so that the pair stays stable (teleop.md 2(b): "K_c ≤ B/T").
  bool softens_with_delay{true};
  // Of a mass between the tip and the spring, which makes the hand's tool heavier; 0: the arm and
  // the hand are the master's mass, else at least kLightestMaster_kg.
  double master_mass_kg{0};
  // What binds it to the tip, where there is one. Ours: harder than K_c, B that of `tool`.
  ToolProperties grip{.stiffness = {1000}, .damping = {5}};
  ConstraintAgeSettings age{};

  // Ours: with the hardest damper that can be said its steps are 49 µs long, 21 in a tick of 1 kHz
  // (move_master()); a lighter one needs more.
  static constexpr double kLightestMaster_kg = 0.02;
};

// The arm half of a PD teleoperator (thesis 3.4): a spring and dampers between the hand, the
// master, and a mass in the world, the slave (SpringDamperWorld), each delayed by T on its way.
//
//   World:  F = −F_s(t−T) − B·v                    F_s  of the controller on the slave, N
//   Both:   F = K_c·(x_s(t−T) − x) − B·v           x_s  of the slave, m
//
// F  force on the master, N      K_c  coupling spring, N/m      T  one way, s; D = 2T
// x, v  of the master: m, m/s    B    damper of the master, N·s/m
//
// Limits (Lee and Spong, Nuño: docs/references.md; teleop.md 2(b), decision 0421), each for a hand
// that damps nothing itself:
//   Both:   stable for 4·B_m·B_s > D²·K_c², here K_c < B/T. Drag (2·B + K_c·D)·v.
//   World:  stable for K_c < 1.5·B/D.  Drag B·v.
// K_c is held below B/T or B/D by 5 %, for the longest round trip since reset(): it only falls,
// which takes energy out. Steady stiffness in contact: K_c in series with the world's.
//
// With a master's mass m: m·dv/dt = F + F_g, F_g = K_g·(p − x) + B_g·(p' − v), and −F_g is felt.
//
// What the hand feels of a silent world, an outage, a restart: FarEndPort. Thread: one servo
// thread. RT: reset(), step() THIMBLE_RT. Frames: base frame of the arm, which is the world's; no
// offset. Errors: FarEndPort's.
class SpringDamperArm final : public ArmCoupling {
 public:
  explicit SpringDamperArm(const SpringDamperSettings& settings = {}) noexcept;

  [[nodiscard]] const FarEndPort& port() const noexcept { return port_; }
  // K_c as it is now.
  [[nodiscard]] Stiffness stiffness() const noexcept { return tool_.stiffness; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  struct Motion {
    Position3 at{};
    Velocity3 velocity{};
  };
  void begin_epoch(const ArmInput& input) noexcept;
  void soften(Duration round_trip) noexcept;
  [[nodiscard]] bool is_between_arms() const noexcept {
    return settings_.is_between_arms || is_told_of_arm_;
  }
  [[nodiscard]] Force3 pull(const Motion& master) const noexcept;
  [[nodiscard]] Force3 move_master(const ArmInput& input) noexcept;

  SpringDamperSettings settings_;
  ToolProperties tool_;
  FarEndPort port_;
  FarEnd far_{};
  bool has_far_{false};
  bool is_told_of_arm_{false};
  Motion master_{};
};

}  // namespace thimble::coupling
