#pragma once

#include <array>
#include <cstdint>

#include "daemon/coupling/far_end_port.hpp"
#include "daemon/coupling/slave.hpp"
#include "daemon/coupling/wave_channel.hpp"
#include "daemon/coupling/world_coupling.hpp"

namespace thimble::coupling {

struct WaveWorldSettings {
  Stiffness stiffness{1000};  // of the slave's own controller; ours: beyond a wall, short of b/T
  // Of the correction of place: 1/s of what is missing, at most so fast, and the energy that it may
  // save up for it. Ours: slow beside any hand; enough to set the slave going.
  double return_per_s{2};
  double return_m_per_s{0.02};
  double return_joule{0.00005};
  SlaveSettings slave{};
};

// The world half of wave-based teleoperation (thesis 3.5): a mass in the world, the slave, whose
// controller follows the wave that arrives and returns what it meets. SOURCE: Niemeyer and Slotine
// (docs/references.md), as derived in teleop.md 2(c); the correction of place is ours.
//
//   v_d = √(2/b)·u − F_s/b       F_s = K_s·(x_d − x_s) + B_s·(v_d + v_c − v_s)
//   w   = u − √(2/b)·F_s         x_d = ∫(v_d + v_c) dt
//
// u, w   arriving and returning wave, √W           F_s  of the controller on the slave, N
// b      of the newest sample, N·s/m               K_s  of the controller, N/m
// x_d, v_d, x_s, v_s  wanted, of the slave: m, m/s     v_c  correction of place, m/s
//
// Matching: B_s = b, so that whatever holds the slave is reached through what the channel ends in
// without an echo. The two equations of v_d and F_s are solved together. A free slave holds
// nothing: there the filter of the arm half ends the wave that goes to and fro with the period 4·T.
//
// Place: as long as b stays, waves say by themselves that x_d = x + (P − P_s)/b, where x and P are
// place and impulse of the hand as the newest sample tells them, and P_s that of F_s. When b
// changes under force, x_d is off by F·T·(1/b − 1/b') and more; v_c brings it there, per axis, and
// only where that takes energy out (F_s·v_c < 0), or spends a little that the damper took. Both
// impulses fade within kImpulseMemory_s: what a change of b left in them does not stay.
//
// Thread: the world's thread. Not RT; answer() neither allocates nor blocks.
// Ownership: `world` must outlive it; the destructor closes. Sessions: as by GhostPointWorld.
// Errors: as RemoteForceWorld's; an overtaken sample only lets time pass.
class WaveWorld final : public WorldCoupling {
 public:
  WaveWorld(world::World& world, std::uint32_t first_session,
            const WaveWorldSettings& settings = {}) noexcept
      : slave_(world, settings.slave), settings_(settings), next_session_(first_session) {}

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { slave_.close(); }

  [[nodiscard]] const Slave& slave() const noexcept { return slave_; }
  [[nodiscard]] const WaveSums& sent() const noexcept { return to_arm_.sums(); }
  [[nodiscard]] const WaveOutlet& incoming() const noexcept { return from_arm_; }

 private:
  [[nodiscard]] Force3 follow(Position3 at, Velocity3 velocity, double step_s) noexcept;
  [[nodiscard]] double correction_m_per_s(std::size_t axis, double pull_newton,
                                          double felt_newton_s_per_m, double step_s) noexcept;

  Slave slave_;
  WaveWorldSettings settings_;
  std::uint32_t next_session_;
  double b_newton_s_per_m_{kLeastImpedance_newton_s_per_m};
  WaveOutlet from_arm_{};
  WaveInlet to_arm_{};
  Position3 wanted_{};  // x_d
  Impulse3 impulse_{};  // P_s
  Position3 hand_{};    // of the newest sample
  Impulse3 hand_impulse_{};
  std::array<double, 3> saved_joule_{};  // of the correction
  std::uint64_t newest_{0};
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
