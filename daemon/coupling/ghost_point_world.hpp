#pragma once

#include <cstdint>

#include "daemon/coupling/messages.hpp"
#include "daemon/coupling/probe_in_world.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/world/world.hpp"

namespace thimble::coupling {

// The world half of the ghost point scheme: a probe follows the hand through the world, and
// what holds it back is the answer. Buttons that were just pressed, and actions
// that were asked, are told to the world.
//
// Thread: the world's thread. Not RT; answer() neither allocates nor blocks.
// Ownership: `world` must outlive it; the destructor closes.
// Errors: open() passes on what the world says. A sample that is not finite, or of which
//         the world cannot say anything, is answered with the last set, its number included: to
//         the arm the world looks silent.
class GhostPointWorld final : public WorldCoupling {
 public:
  // Sessions are numbered from `first_session` up. A process that restarts passes a number
  // that its forerunner did not reach (e.g. from the clock), so that arms notice.
  GhostPointWorld(world::World& world, std::uint32_t first_session) noexcept;

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { probe_.close(); }

 private:
  ProbeInWorld probe_;
  std::uint32_t next_session_;
  ConstraintSet last_{};
};

}  // namespace thimble::coupling
