#include "daemon/world/cam/piece_drift.hpp"

#include <random>

#include "daemon/world/cam/piece_programs.hpp"

namespace thimble::world::cam {
namespace {

using namespace cam_step;

class Drift final : public PieceTask {
 public:
  Drift(const PieceContext& context, std::uint64_t n) : context_(context), n_(n) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before != nullptr) return std::nullopt;
    const auto kicks = drift_kicks(n_, context_.settings.space, longest_kick(context_));
    const CamAxes back{-kicks.forth[0], -kicks.forth[1], -kicks.forth[2]};
    const bool is_emitting = context_.state.held != 0;
    const auto said = static_cast<std::uint16_t>(cell::kDrift | (is_emitting ? cell::kEmit : 0));
    return CamSteps{
        Fix{cell::kDrift | cell::kEmit, said},
        Kick{{{cell::kForth, kicks.forth}, {cell::kBack, back}, {cell::kDice, kicks.dice}}}, Run{},
        Fix{}};
  }

 private:
  PieceContext context_;
  std::uint64_t n_;
};

}  // namespace

DriftKicks drift_kicks(std::uint64_t n, const CamGeometry& space, const CamAxes& longest) noexcept {
  DriftKicks kicks;
  std::array<std::size_t, 3> axes{};
  std::size_t count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (space.log2_cells[axis] > 0) axes[count++] = axis;
  }
  if (count == 0) return kicks;
  kicks.forth[axes[n % count]] = 1;
  std::mt19937 random(static_cast<std::mt19937::result_type>(n));
  for (std::size_t i = 0; i < count; ++i) {
    const int most = longest[axes[i]];
    const auto ways = static_cast<unsigned>(2 * most + 1);
    kicks.dice[axes[i]] = static_cast<int>(random() % ways) - most;
  }
  return kicks;
}

void put_dice(CamCells& cells) noexcept {
  std::mt19937 random;
  for (std::uint16_t& bits : cells) {
    if ((random() & 1U) != 0) bits |= cell::kDice;
  }
}

void take_particles(CamCells& cells) noexcept {
  constexpr auto kOthers = static_cast<std::uint16_t>(~(cell::kParticles | cell::kDice));
  for (std::uint16_t& bits : cells) bits &= kOthers;
}

std::unique_ptr<PieceTask> make_drift(const PieceContext& context, std::uint64_t n) {
  return std::make_unique<Drift>(context, n);
}

}  // namespace thimble::world::cam
