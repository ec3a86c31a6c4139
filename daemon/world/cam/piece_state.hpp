#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "daemon/world/cam/piece_layout.hpp"
#include "daemon/world/cam/piece_rules.hpp"
#include "daemon/world/cam/piece_search.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

// What can be done to pieces; at any time, also without a hand.
enum class PieceAction : std::uint8_t {
  Select,      // the piece that the grasp point touches, where the hand presses
  Drop,        // the held piece, where nothing lies
  Delete,      // the held piece
  ToggleFree,  // free motion: the shape passes through everything, or no longer
  Reset,       // all pieces as they were at first
  Look,        // reads where they are; nothing changes
};

// What became of it.
enum class PieceOutcome : std::uint8_t {
  Selected,
  Dropped,
  Deleted,
  FreeMotionOn,
  FreeMotionOff,
  WasReset,
  Looked,        // PieceBoard::picture() is as they are now
  NothingThere,  // to select
  NoRoom,        // to drop it
  NothingHeld,   // to drop or delete
  AlreadyHeld,   // a piece: another one cannot be selected
  BoardFailed,   // and it is not known whether it was done; the world says how it is now
  NoBoard,       // that works: it was not begun, nor will be
};
[[nodiscard]] std::string_view to_string(PieceOutcome outcome) noexcept;

// In a picture of dynamic pieces, of a free cell with particles.
inline constexpr std::uint8_t kParticleSeen = kMostPieces + 1;

// How it uses the board.
struct PieceSettings {
  CamGeometry space{};
  SearchKind search{SearchKind::Leap};
  // Thesis, appendix C: a scan to shift and one to count. Else the scan that shifts counts, too.
  bool counts_apart{false};
  // Thesis 4.2.4: the held piece gives off particles, a deleted one becomes a cloud of them; at
  // most kMostDynamicPieces. They are seen, not felt.
  bool is_dynamic{false};
  // Moves after which the slice of the grasp point is shown on the board's monitor (thesis 4.2.2:
  // 7); 0: never. Of a world; a PieceBoard shows when it is told to.
  int moves_a_picture{0};
  // For one program. Ours: the longest, 512 x 512 cells there and a table, takes 20 ms at 25 MHz.
  Duration patience{std::chrono::seconds(1)};
};

// What the board has confirmed; all that the host remembers of it.
struct PieceState {
  CamAxes grasp{};      // where the grasp point is; within the space
  int held{0};          // number of the held piece; 0: the grasp point moves alone
  CamAxes held_from{};  // the grasp point when it was selected: the shape has moved as far
  bool is_free_motion{false};
  bool is_embedded{false};  // the shape lies on a piece; it may move until it does not
  CamAxes touching{};       // as the last move left it: PieceSearch::touching()
  PieceSizes sizes{};       // of the pieces that there are; 0: deleted
  PieceBoxes boxes{};       // likewise, where they rest; of the held one, where it did
  // A program under way that changes which piece is held: what it will be. Its failure leaves open
  // whether it was done.
  std::optional<int> held_next{};
  bool is_deleting{false};  // likewise: it deletes the held piece
  bool operator==(const PieceState&) const = default;
};

}  // namespace thimble::world::cam
