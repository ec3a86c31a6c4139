#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "daemon/world/cam/piece_board.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/time.hpp"

namespace thimble::world::cam {

struct PieceWorldSettings {
  PieceSettings pieces{};
  double workspace_m{0.09};  // along the longest axis of the space; cells are cubes
  std::string source{};      // for messages
  // Thesis 5.3.2: faces are as stiff as there are cells that press on them, so much each; as with
  // materials, an arm has the last word. The force that comes of it where the hand was told to be
  // is told, too (ProbeMotion::pressure). 0: faces are as the arm has them. At least 0.
  Stiffness pressure{0};
};

// Pieces that one hand explores, selects, moves and drops (thesis 4.2). The ghost point is the
// grasp point, and follows the hand as far as the board says; along an axis of a single cell
// nothing holds the hand. The world has walls, though a held piece passes from edge to edge.
//
// A board takes its time: between two of its answers the last one holds, for kOverdue. After that,
// while the board has failed, and until it has looked where the hand is now, the world is silent
// (ProbeMotion::is_silent).
//
// Thread: one, the world's. Not RT: move_probe() plays step lists, and waits for none; a simulated
// board scans in it. Ownership: the clock must outlive it.
class PieceWorld final : public World {
 public:
  // Ours: more is somebody who does not wait for answers.
  static constexpr std::size_t kMaxWaiting = 64;
  // Ours: how soon a board is missed that nothing is asked of.
  static constexpr Duration kLookEvery = std::chrono::milliseconds(100);

  // How long a move may take, or one program of anything else, before what was felt last is not
  // believed any more; a board's patience is longer, and its page may beat while its machine hangs.
  // As long as a move took on the slowest machine of the thesis, of four boards; a table over USB
  // at full speed takes 130 ms. A hand that is at rest lets go as soon after as its constraints
  // are old (250 ms) and faded (100 ms).
  static constexpr Duration kOverdue = std::chrono::milliseconds(250);

  // Ours, of dynamic pieces: a particle gets a cell along each axis of a space within 60 ms, and a
  // drift is one scan.
  static constexpr Duration kDriftEvery = std::chrono::milliseconds(20);

  struct Finished {
    std::uint64_t number{0};
    PieceOutcome outcome{};
  };

  // Errors: InvalidArgument for a workspace that is none.
  [[nodiscard]] static Result<std::unique_ptr<PieceWorld>> create(
      const PieceWorldSettings& settings, PieceBoard::Opener opener, PieceLayout layout,
      const Clock& clock);

  [[nodiscard]] const WorldInfo& info() const noexcept override { return info_; }
  [[nodiscard]] PieceWorld* pieces() noexcept override { return this; }
  [[nodiscard]] bool may_fall_silent() const noexcept override { return true; }
  // Busy: there is one grasp point.
  [[nodiscard]] Result<ProbeId> add_probe(Position3 hand) override;
  void remove_probe(ProbeId probe) noexcept override;
  // The first selects the piece that the hand presses, or drops the held one; the second deletes
  // it. What does not fit into the queue is as if it had not been pressed, and so is what is
  // pressed while the board has failed.
  void press(ProbeId probe, std::uint32_t buttons) noexcept override;
  [[nodiscard]] bool has_actions() const noexcept override { return true; }
  // As submit(). What is asked while the board has failed is taken, and is not done.
  [[nodiscard]] bool act(ProbeId probe, HandAction action) noexcept override;
  ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept override;
  // From then on the board looks around the ghost after each move to another cell, before the next
  // one (PieceBoard::look_around()), until the probe is removed.
  void mark_zone(std::int32_t cells) override { zone_cells_ = std::max(zone_cells_, cells); }
  // Where it searches by the trail in its box: in the whole space a look takes a board 20 times as
  // long (decision 0482).
  [[nodiscard]] bool finds_zone_faces() const noexcept override {
    return board_.settings().search == SearchKind::BoundedSweep;
  }
  // Of what the shape would meet, and the edges of the space. A face along the way that the ghost
  // has come is where it is; one beside it may be that of the cell where the board looked last.
  // None lies behind the ghost. Of pieces nothing is told in free motion, nor before the board has
  // looked at them as they are.
  [[nodiscard]] ZoneFaces zone_faces() const noexcept override;

  // To be done in their order. The number, from 1. Errors: Busy while kMaxWaiting wait.
  // None outlives a failure of the board: those that wait come to an end with it, and what is asked
  // while it lasts at once (NoBoard). Whoever asked has gone on, and the hand is elsewhere.
  [[nodiscard]] Result<std::uint64_t> submit(PieceAction action);
  // Not to be done any more. False: it has begun, or is over.
  bool withdraw(std::uint64_t number);
  // What came to an end since the last call.
  [[nodiscard]] std::vector<Finished> take_finished();
  // Goes on, hand or not.
  void pump();

  [[nodiscard]] const PieceBoard& board() const noexcept { return board_; }

 private:
  // Select or drop is decided when its turn has come.
  struct Waiting {
    std::uint64_t number{0};
    std::optional<PieceAction> action{};
  };
  // What a move started from: the same again would end the same.
  struct Try {
    CamAxes target{};
    PieceState from{};
    bool operator==(const Try&) const = default;
  };

  PieceWorld(const PieceWorldSettings& settings, PieceBoard::Opener opener, PieceLayout layout,
             const Clock& clock);
  [[nodiscard]] Result<std::uint64_t> enqueue(std::optional<PieceAction> action);
  void note_end();
  void begin_anew() noexcept;
  void forget_hand() noexcept;
  void give_up();
  // Whether the next action is a look behind another one, and the hand has had no move since.
  [[nodiscard]] bool must_let_hand_go_first() const;
  void begin_action();
  // Whether one was begun.
  [[nodiscard]] bool begin_move(MonotonicTime now);
  [[nodiscard]] bool begin_drift(MonotonicTime now);
  [[nodiscard]] bool begin_picture();
  [[nodiscard]] bool begin_zone();
  // One beyond the space where the hand is beyond it.
  [[nodiscard]] CamAxes cell_of(Position3 hand) const noexcept;
  [[nodiscard]] CamAxes nearest_within(CamAxes cell) const noexcept;
  [[nodiscard]] bool is_overdue() const;
  [[nodiscard]] double face_m(std::size_t axis, int index) const noexcept;
  // As the board has found it, or nothing. `way`: -1, +1.
  [[nodiscard]] std::optional<ContactPlane> zone_face(std::size_t axis, int way) const noexcept;
  [[nodiscard]] ProbeMotion motion() const;
  // Where cells are counted, the stiffness of a face across `axis` and the force with which they
  // press back on the hand.
  void press_back(std::size_t axis, ContactPlane& plane, ProbeMotion& motion) const noexcept;

  PieceBoard board_;
  const Clock* clock_;
  CamAxes cells_;
  Stiffness pressure_;
  WorldInfo info_;
  std::optional<ProbeId> probe_;
  std::uint32_t last_id_{0};
  Position3 hand_{};
  bool is_placing_{false};  // the ghost starts at the hand, whatever is between
  std::uint64_t resets_seen_{0};
  std::optional<CamAxes> goal_;  // of the move under way: the hand's cell
  bool has_looked_{false};       // for this hand, on the board as it is
  bool has_shown_{false};        // all cells to a client, since the hand's last move
  std::int32_t zone_cells_{0};   // 0: nobody wants a zone
  CamAxes pressed_{};            // by the hand, as the last answer has it: -1, 0, 1
  std::optional<Try> last_try_;
  MonotonicTime looked_at_{};
  std::optional<MonotonicTime> drift_at_;
  std::uint64_t moves_shown_{0};  // before the last picture
  std::deque<Waiting> waiting_;
  std::optional<std::uint64_t> under_way_;
  std::vector<Finished> finished_;
  std::uint64_t last_number_{0};
};

}  // namespace thimble::world::cam
