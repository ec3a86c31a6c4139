#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hal/device/cam_board.hpp"

// The rules of static pieces (thesis 4.2.1 and appendix C) as tables of a CAM board: up to 63
// pieces rest in the cells; one of them, or the grasp point alone, moves as a shape. Those of
// dynamic pieces (4.2.4) are the same for the seven whose numbers leave three layers free, in which
// particles drift.
namespace thimble::world::cam {

inline constexpr int kMostPieces = 63;
inline constexpr int kMostDynamicPieces = 7;

// What the bits of a cell are. Thesis, appendix C; `origin` is ours.
namespace cell {
inline constexpr int kOriginLayer = 0;   // where the held piece was when it was selected
inline constexpr int kShapeLayer = 1;    // what moves: the held piece, or else the grasp point
inline constexpr int kGraspLayer = 2;    // the grasp point, one cell of the space
inline constexpr int kOverlapLayer = 3;  // the shape lies on a resting piece
inline constexpr int kPartLayer = 4;     // to 9: number of the resting piece, 0 for none
inline constexpr int kSelectLayer = 10;  // to 15: what the host says; shown while nothing is said
inline constexpr int kNumberLayers = 6;
// While the way ahead is swept, ours: `select` shows nothing then.
inline constexpr int kTrailLayer = 10;   // where the shape would have been
inline constexpr int kAheadLayer = 11;   // the same, to be kicked ahead
inline constexpr int kHitLayer = 12;     // of the trail, what lies on a resting piece
inline constexpr int kBeginsLayer = 15;  // fixed by the host: the trail begins anew at the shape

// Of dynamic pieces, ours: layers of numbers above 7, and of what is said of them.
inline constexpr int kForthLayer = 7;   // a particle that goes forth with the next drift
inline constexpr int kBackLayer = 8;    // one that goes back
inline constexpr int kDiceLayer = 9;    // half of the cells; whoever meets one turns around
inline constexpr int kDriftLayer = 13;  // fixed by the host: this scan is a drift
inline constexpr int kEmitLayer = 14;   // likewise: the shape gives off particles

inline constexpr std::uint16_t kOrigin = 1U << kOriginLayer;
inline constexpr std::uint16_t kShape = 1U << kShapeLayer;
inline constexpr std::uint16_t kGrasp = 1U << kGraspLayer;
inline constexpr std::uint16_t kOverlap = 1U << kOverlapLayer;
inline constexpr std::uint16_t kMoving = kShape | kGrasp;
inline constexpr std::uint16_t kTrail = 1U << kTrailLayer;
inline constexpr std::uint16_t kAhead = 1U << kAheadLayer;
inline constexpr std::uint16_t kHit = 1U << kHitLayer;
inline constexpr std::uint16_t kBegins = 1U << kBeginsLayer;
inline constexpr std::uint16_t kForth = 1U << kForthLayer;
inline constexpr std::uint16_t kBack = 1U << kBackLayer;
inline constexpr std::uint16_t kDice = 1U << kDiceLayer;
inline constexpr std::uint16_t kParticles = kForth | kBack;
inline constexpr std::uint16_t kDrift = 1U << kDriftLayer;
inline constexpr std::uint16_t kEmit = 1U << kEmitLayer;
inline constexpr std::uint16_t kPart = kMostPieces << kPartLayer;
inline constexpr std::uint16_t kSelect = kMostPieces << kSelectLayer;

[[nodiscard]] constexpr int part_of(std::uint16_t bits) noexcept {
  return (bits & kPart) >> kPartLayer;
}
[[nodiscard]] constexpr std::uint16_t of_part(int part) noexcept {
  return static_cast<std::uint16_t>(part << kPartLayer);
}
[[nodiscard]] constexpr std::uint16_t selecting(int part) noexcept {
  return static_cast<std::uint16_t>(part << kSelectLayer);
}
}  // namespace cell

// What becomes of a cell. Pure.
//
// While things move: marks where the shape overlaps, and shows each cell's piece.
[[nodiscard]] std::uint16_t overlap_rule(std::uint16_t bits) noexcept;
// The piece under the grasp point comes into `select`, 0 elsewhere: summed, it is its number.
[[nodiscard]] std::uint16_t grasp_rule(std::uint16_t bits) noexcept;
// The piece that `select` says becomes the shape, and leaves its origin behind.
[[nodiscard]] std::uint16_t select_rule(std::uint16_t bits) noexcept;
// The shape becomes the piece that `select` says, or nothing where that is 0; what it lies on
// then stays. The grasp point is the shape.
[[nodiscard]] std::uint16_t deposit_rule(std::uint16_t bits) noexcept;

// The trail grows by what ran ahead of it, and is marked where it lies on a piece.
[[nodiscard]] std::uint16_t sweep_rule(std::uint16_t bits) noexcept;

// Dynamic pieces, in a drift, after particles and dice have moved: a particle in a piece is lost to
// it, the shape gives off two where the dice say so if the host does, and where they say so again
// particles turn around. Other bits stay.
[[nodiscard]] std::uint16_t drift_rule(std::uint16_t bits) noexcept;

// All of them as tables, made once and shared.
struct PieceTables {
  std::shared_ptr<const CamTable> overlap, grasp, select, deposit, sweep;
};
// Dynamic: motion drifts where the host says kDrift, what is deleted becomes particles, two a cell,
// and no rule shows a number above 7, so that kDrift is 0 where it is not said.
// Not shown: `select` is 0 everywhere but for grasp_rule's answer, so that a trail has nothing of
// the picture around it; the pieces are where their numbers are.
[[nodiscard]] PieceTables make_piece_tables(bool is_dynamic = false, bool is_shown = true);

}  // namespace thimble::world::cam
