#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "hal/device/cam_board.hpp"

// The rules of static pieces (thesis 4.2.1 and appendix C) as tables of a CAM board: up to 63
// pieces rest in the cells; one of them, or the grasp point alone, moves as a shape.
namespace thimble::world::cam {

inline constexpr int kMostPieces = 63;

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

inline constexpr std::uint16_t kOrigin = 1U << kOriginLayer;
inline constexpr std::uint16_t kShape = 1U << kShapeLayer;
inline constexpr std::uint16_t kGrasp = 1U << kGraspLayer;
inline constexpr std::uint16_t kOverlap = 1U << kOverlapLayer;
inline constexpr std::uint16_t kMoving = kShape | kGrasp;
inline constexpr std::uint16_t kTrail = 1U << kTrailLayer;
inline constexpr std::uint16_t kAhead = 1U << kAheadLayer;
inline constexpr std::uint16_t kHit = 1U << kHitLayer;
inline constexpr std::uint16_t kBegins = 1U << kBeginsLayer;
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

// All of them as tables, made once and shared.
struct PieceTables {
  std::shared_ptr<const CamTable> overlap, grasp, select, deposit, sweep;
};
[[nodiscard]] PieceTables make_piece_tables();

}  // namespace thimble::world::cam
