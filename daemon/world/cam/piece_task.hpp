#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "daemon/world/cam/piece_state.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

// Something that takes several programs of the board, each of which depends on what the one before
// has read. Thread: one, the world's. Ownership: all that a context refers to must outlive it.
class PieceTask {
 public:
  virtual ~PieceTask() = default;
  // `before`: what the last program read; nullptr at first. Nothing: it is over. The state is then,
  // and after every program, what the board has confirmed.
  [[nodiscard]] virtual std::optional<CamSteps> next(const CamAnswer* before) = 0;
  // When it is over, of an action.
  [[nodiscard]] virtual std::optional<PieceOutcome> outcome() const { return std::nullopt; }
};

struct PieceContext {
  const PieceSettings& settings;
  const PieceTables& tables;
  PieceState& state;
  int modules{1};
  bool& is_sweep_ready;  // its table is the one that is not in force
};

// Moves the shape as far as it gets; in free motion, or out of a piece, all the way.
[[nodiscard]] std::unique_ptr<PieceTask> make_move(const PieceContext& context,
                                                   const CamAxes& desired);
// The same by SweepSearch, whatever the settings say.
[[nodiscard]] std::unique_ptr<PieceTask> make_sweep(const PieceContext& context,
                                                    const CamAxes& desired);
// All the way whatever lies there; the shape is embedded then.
[[nodiscard]] std::unique_ptr<PieceTask> make_placing(const PieceContext& context,
                                                      const CamAxes& desired);
// `pressed`: which way the hand presses along each axis, -1, 0 or 1; there the piece is looked for
// that the grasp point does not lie on.
[[nodiscard]] std::unique_ptr<PieceTask> make_select(const PieceContext& context,
                                                     const CamAxes& pressed);
[[nodiscard]] std::unique_ptr<PieceTask> make_drop(const PieceContext& context);
[[nodiscard]] std::unique_ptr<PieceTask> make_delete(const PieceContext& context);
// Free motion on, or off; then the shape is embedded where it lies on a piece.
[[nodiscard]] std::unique_ptr<PieceTask> make_toggle(const PieceContext& context);
// A step of all particles, the nth. Only of dynamic pieces.
[[nodiscard]] std::unique_ptr<PieceTask> make_drift(const PieceContext& context, std::uint64_t n);
// Reads where pieces are into `picture`, which must outlive it.
[[nodiscard]] std::unique_ptr<PieceTask> make_look(const PieceContext& context,
                                                   PieceLayout& picture);
// The slice of the grasp point on the board's monitor.
[[nodiscard]] std::unique_ptr<PieceTask> make_picture(const PieceContext& context);
// Puts cells onto a board that has been laid out, and the rules in force. The cells show what the
// state says.
[[nodiscard]] std::unique_ptr<PieceTask> make_fill(const PieceContext& context,
                                                   std::shared_ptr<const CamCells> cells);

}  // namespace thimble::world::cam
