#pragma once

#include <cstdint>

#include "daemon/coupling/slave.hpp"
#include "daemon/coupling/spring_damper.hpp"
#include "daemon/coupling/world_coupling.hpp"

namespace thimble::coupling {

// The world half of a PD teleoperator (thesis 3.4): a mass in the world, the slave, pulled by
//
//   World:  F_s = K_c·(x(t−T) − x_s) + B_c·(v(t−T) − v_s),  B_c = B/2; −F_s is the answer
//   Both:   F_s = K_c·(x(t−T) − x_s) − B·v_s;               x_s is the answer
//
// x, v      of the master (SpringDamperArm), as its newest sample says: m, m/s
// x_s, v_s  of the slave: m, m/s       K_c, B  of that sample (HandSample::tool): N/m, N·s/m
//
// Why half of B (World): a blocked slave answers K_c·x + B_c·v, D late; with the master's B that
// takes energy at every frequency ω for B + B_c·cos(ωD) − K_c·sin(ωD)/ω > 0. With B_c = B that
// fails at ωD = π whatever K_c; with half of it, it holds for K_c·D < 1.5·B (decision 0421).
//
// SOURCE: as of SpringDamperArm. Between two samples the slave goes on towards the older. K_c and B
// count up to kHardestController. Thread: the world's. Not RT; answer() neither allocates nor
// blocks. Ownership: `world` must outlive it; the destructor closes. Sessions: as by
// GhostPointWorld. Errors: as RemoteForceWorld's; an overtaken sample only lets time pass.
class SpringDamperWorld final : public WorldCoupling {
 public:
  SpringDamperWorld(world::World& world, std::uint32_t first_session,
                    ForceAt force_at = ForceAt::World, const SlaveSettings& slave = {}) noexcept
      : slave_(world, slave), force_at_(force_at), next_session_(first_session) {}

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { slave_.close(); }
  [[nodiscard]] const Slave& slave() const noexcept { return slave_; }

 private:
  [[nodiscard]] Force3 pull(Position3 at, Velocity3 velocity) const noexcept;

  Slave slave_;
  ForceAt force_at_;
  std::uint32_t next_session_;
  HandSample goal_{};
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
