#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/port_account.hpp"
#include "daemon/coupling/world_coupling.hpp"

namespace thimble::coupling {

// The world's end of a passivity guard between both ends (TwoPortArm), around a world half that
// follows the hand's place and answers with a force. Its port is where the two meet: the place that
// the hand is taken to be at, and the force that is told.
//
//   E_out,S(k) <= E_in,M(k − D₁) + E_0         W = −F(k−1)·(x(k) − x(k−1))
//   x(k) = x(k−1) + λ·(q(k) − x(k−1))           λ = min(1, left/W) where W > 0, else 1
//
// q  hand of the sample, m         F  on the hand, as told, N         left, W  port_account.hpp, J
// x  where it is taken to be, m    D₁ from arm to world, s
//
// So the hand goes on into a wall only as far as the energy goes that it is known to have put in: a
// wall is felt up to v·D deeper than it is, and where it is again once there is energy for it, at
// once in free space. Its velocity counts by the same share. The force is that of the world half,
// unchanged: what is passive there stays so.
//
// Between samples force and place change together: of the forces before and after a step, that
// which makes more come out and less go in is counted. So a long step into a wall, of which the
// force before says nothing, is paid for by the next ones.
//
// Samples that tell no energy, of an arm without such a guard, pass unchanged.
//
// Thread: the world's. Not RT; answer() neither allocates nor blocks. Ownership: of what is inside.
// Errors: those of the world half inside.
class TwoPortWorld final : public WorldCoupling {
 public:
  explicit TwoPortWorld(std::unique_ptr<WorldCoupling> inside,
                        const PassivitySettings& settings = {}) noexcept
      : inside_(std::move(inside)), account_(settings.bound_joule, settings.credit_joule) {}

  [[nodiscard]] Result<void> open(const HandSample& first) override;
  [[nodiscard]] ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override;
  void close() noexcept override { inside_->close(); }

  // x
  [[nodiscard]] Position3 place() const noexcept { return place_; }

 private:
  [[nodiscard]] HandSample held_back(const HandSample& sample) const noexcept;

  std::unique_ptr<WorldCoupling> inside_;
  PortAccount account_;
  Position3 place_{};
  Force3 told_{};
  std::uint64_t newest_{0};
};

}  // namespace thimble::coupling
