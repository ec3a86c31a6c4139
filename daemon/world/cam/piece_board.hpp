#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "daemon/world/cam/piece_layout.hpp"
#include "daemon/world/cam/piece_state.hpp"
#include "daemon/world/cam/piece_task.hpp"
#include "daemon/world/cam/piece_zone.hpp"
#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

struct PieceBoardCounters {
  std::uint64_t programs{0};  // that are over
  std::uint64_t moves{0};     // likewise
  std::uint64_t drifts{0};    // likewise
  std::uint64_t pictures{0};  // likewise
  std::uint64_t zones{0};     // likewise, around the grasp point
  std::uint64_t actions{0};
  std::uint64_t failures{0};  // of the board
  std::uint64_t repairs{0};   // after which all pieces were there
  std::uint64_t resets{0};    // after which they were not, so that all was put as it was at first
  bool operator==(const PieceBoardCounters&) const = default;
};

// Pieces on a board of cellular automata, which is the only one to know where they are: the host
// remembers what it confirmed (PieceState). Does one thing after the other, none of which waits.
//
// What a board counts is believed as far as it can be: more cells than there are, or a piece that
// there is none of, is a failure.
// A board that fails is tried again every kRetry, opened anew if it is gone, does not fit
// the space or its programs, or was too late kMostTimeouts times in a row, and then what it holds
// is read and made whole.
// Thread: one, the world's. Not RT. Errors: trouble().
class PieceBoard {
 public:
  // Errors: why there is no board now; it is asked again.
  using Opener = std::function<Result<std::unique_ptr<CamBoard>>(MonotonicTime now)>;
  // Ours: a board that was plugged in again is felt at once.
  static constexpr Duration kRetry = std::chrono::milliseconds(100);
  // In a row: a board that is too slow, or no board at all, is not kept for ever. Ours: a module
  // that hangs is well after the first reset, or not at all.
  static constexpr int kMostTimeouts = 3;
  // Of one call of pump(), with a board that takes no time, or with one whose scans are done by the
  // caller: then it goes on with the next call. Ours: half the period of the servo's default, on
  // the thread that serves links and clients, too.
  static constexpr int kMostPrograms = 1024;
  static constexpr Duration kMostAtOnce = std::chrono::microseconds(500);

  // `grasp`: where the grasp point is at first. Sizes as random_layout() has them; dynamic pieces
  // have numbers up to kMostDynamicPieces.
  PieceBoard(Opener opener, const PieceSettings& settings, PieceLayout layout,
             const CamAxes& grasp);

  // Goes on until the board needs time or nothing is under way.
  void pump(const Clock& clock);
  // It is there, and nothing is under way.
  [[nodiscard]] bool is_ready() const noexcept { return phase_ == Phase::Working && !task_; }
  // When the program that is under way was given to the board; nothing: none is.
  [[nodiscard]] std::optional<MonotonicTime> running_since() const noexcept;
  // Only when it is ready: else mistakes of the caller. pump() does it.
  void move(const CamAxes& desired);
  // The same, whatever lies on the way; nowhere: only looks whether the board is there.
  void place(const CamAxes& desired);
  void act(PieceAction action, const CamAxes& pressed);
  // A step of all particles. Only of dynamic pieces.
  void drift();
  // The slice of the grasp point on the board's monitor, once, which takes a frame of it or two. A
  // board that refuses it, or fails at it, is not to be asked again until it is opened anew
  // (why_dark()).
  void show();
  // What is free around the grasp point, as far as `cells`. Not in free motion, nor embedded.
  void look_around(int cells);
  // Of an action, once.
  [[nodiscard]] std::optional<PieceOutcome> take_outcome() noexcept;

  // Where pieces were when somebody looked last, the held one with them; empty before. What it lies
  // on is hidden. kParticleSeen where there are particles.
  [[nodiscard]] const PieceLayout& picture() const noexcept { return picture_; }
  // As look_around() found it last, and the pieces still are; the shape may have moved since,
  // freely.
  [[nodiscard]] const std::optional<PieceZone>& zone() const noexcept { return zone_; }
  [[nodiscard]] const PieceState& state() const noexcept { return state_; }
  [[nodiscard]] const PieceSettings& settings() const noexcept { return settings_; }
  // Why there is nothing to be felt; nothing: it works, or has not been begun.
  [[nodiscard]] const std::optional<Error>& trouble() const noexcept { return trouble_; }
  // Why this board shows nothing; nothing: it does, or has not been asked.
  [[nodiscard]] const std::optional<Error>& why_dark() const noexcept { return why_dark_; }
  [[nodiscard]] const PieceBoardCounters& counters() const noexcept { return counters_; }

 private:
  // What the task under way is; the cells that are put onto a board anew are nobody's.
  enum class Doing { Nothing, Move, Action, Drift, Picture, Zone };
  enum class Phase { Closed, Reading, Filling, Working };

  [[nodiscard]] bool is_due(MonotonicTime now) const noexcept {
    return !retry_at_ || now >= *retry_at_;
  }
  // Each: whether there is more to do now.
  [[nodiscard]] bool open(MonotonicTime now);
  [[nodiscard]] bool go_on(const CamAnswer* answer, MonotonicTime now);
  [[nodiscard]] bool play(const CamSteps& steps, MonotonicTime now);
  bool fail_with(const Error& why, MonotonicTime now);
  // No more pictures of this board, which has refused one or failed at it.
  void darken(const Error& why);
  void close();
  void fill(CamCells cells);
  void start_over();
  void end_task();
  [[nodiscard]] PieceContext context() noexcept;

  Opener opener_;
  PieceSettings settings_;
  PieceLayout layout_;
  CamAxes first_grasp_;
  PieceTables tables_;
  std::unique_ptr<CamBoard> board_;
  Phase phase_{Phase::Closed};
  bool has_cells_{false};  // of ours, on the board or one before it
  PieceState state_;
  std::unique_ptr<PieceTask> task_;
  bool is_sweep_ready_{false};  // as PieceContext
  Doing doing_{Doing::Nothing};
  std::optional<PieceOutcome> outcome_;
  PieceLayout picture_;
  std::optional<PieceZone> zone_;
  std::optional<MonotonicTime> retry_at_;
  MonotonicTime given_at_{};  // the program that was given last
  int timeouts_{0};           // since the board was opened, or since a program was over
  std::optional<Error> trouble_;
  std::optional<Error> why_dark_;
  PieceBoardCounters counters_;
};

}  // namespace thimble::world::cam
