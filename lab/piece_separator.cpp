#include "lab/piece_separator.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::lab {
namespace {

namespace pieces = world::cam;
using pieces::PieceAction;
using pieces::PieceOutcome;

// How deep a tooth is. SOURCE: ours.
constexpr int kTooth_cells = pieces::kLeastThickness_cells / 2;
// Some ten times as many as it takes with most seeds. SOURCE: ours.
constexpr std::uint64_t kMostMoves = 2'000;

// SOURCE: Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (SplitMix64).
std::uint64_t next_random(std::uint64_t& state) {
  std::uint64_t z = state += 0x9e3779b97f4a7c15;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  return z ^ z >> 31;
}

[[nodiscard]] Error disagreement(const std::string& what) {
  return {Errc::System, "the board is not as it must be: " + what};
}

// Which piece along an axis, of a block cut into `across`, with the cuts moved by a tooth or none.
[[nodiscard]] int part_along(int at, int begin, int thick, int across, int tooth) {
  return std::clamp((at - begin + tooth) / thick, 0, across - 1);
}

}  // namespace

Result<pieces::PieceLayout> interlocking_layout(const CamGeometry& space, int across,
                                                std::uint64_t seed) {
  const CamAxes cells = pieces::cells_along(space);
  const int side = std::min(cells[0], cells[1]) / 2;
  const int thick = across > 0 ? side / across : 0;
  if (thick < 2 * pieces::kLeastThickness_cells || across * across > pieces::kMostPieces) {
    return fail(Errc::InvalidArgument, "pieces: so many do not go into the middle of the space");
  }
  // A band of rows, so high that no leap passes it, either keeps to the cuts or has teeth across.
  std::uint64_t random = seed;
  std::vector<int> teeth(static_cast<std::size_t>(side / pieces::kLeastThickness_cells + 1));
  for (int& tooth : teeth) tooth = next_random(random) % 2 == 0 ? 0 : kTooth_cells;
  pieces::PieceLayout layout(space.cells());
  for (int y = 0; y < thick * across; ++y) {
    for (int x = 0; x < thick * across; ++x) {
      // Teeth along x only, so that a piece comes out sideways or not at all.
      const int tooth = teeth[static_cast<std::size_t>(y / pieces::kLeastThickness_cells)];
      const int column = part_along(x, 0, thick, across, x < thick / 2 ? 0 : tooth);
      const int row = y / thick;
      const CamAxes at{x + (cells[0] - thick * across) / 2, y + (cells[1] - thick * across) / 2, 0};
      layout[pieces::index_of(space, at)] = static_cast<std::uint8_t>(1 + column + across * row);
    }
  }
  return layout;
}

PieceSeparator::PieceSeparator(pieces::PieceBoard& board, const pieces::PieceLayout& layout,
                               std::uint64_t seed, Wait wait)
    : board_(&board),
      cells_(pieces::cells_along(board.settings().space)),
      random_(seed),
      wait_(std::move(wait)) {
  CamAxes at{};
  for (at[2] = 0; at[2] < cells_[2]; ++at[2]) {
    for (at[1] = 0; at[1] < cells_[1]; ++at[1]) {
      for (at[0] = 0; at[0] < cells_[0]; ++at[0]) {
        const int number = layout[pieces::index_of(board.settings().space, at)];
        const auto known = std::find_if(pieces_.begin(), pieces_.end(),
                                        [&](const Piece& one) { return one.number == number; });
        if (number != 0 && known == pieces_.end()) pieces_.push_back({number, at, false});
      }
    }
  }
  report_.pieces = static_cast<int>(pieces_.size());
}

int PieceSeparator::below(int count) {
  return static_cast<int>(next_random(random_) % static_cast<std::uint64_t>(count));
}

// Only pieces that are not free are moved: with all of them moved, one runs into another about as
// often as one comes free.
Result<SeparatorReport> PieceSeparator::run(std::uint64_t most_moves) {
  while (report_.moves < most_moves) {
    std::vector<Piece*> stuck = stuck_pieces();
    if (stuck.empty()) {
      // One that was free may lie beside another now.
      for (Piece& piece : pieces_) {
        if (const auto looked = look(piece); !looked) return tl::unexpected(looked.error());
      }
      stuck = stuck_pieces();
    }
    if (stuck.empty()) break;
    Piece& piece = *stuck[static_cast<std::size_t>(below(static_cast<int>(stuck.size())))];
    if (const auto freed = free_up(piece); !freed) return tl::unexpected(freed.error());
  }
  report_.apart = report_.pieces - static_cast<int>(stuck_pieces().size());
  return report_;
}

std::vector<PieceSeparator::Piece*> PieceSeparator::stuck_pieces() {
  std::vector<Piece*> stuck;
  for (Piece& piece : pieces_) {
    if (!piece.is_apart) stuck.push_back(&piece);
  }
  return stuck;
}

Result<void> PieceSeparator::free_up(Piece& piece) {
  if (auto taken = take(piece); !taken) return taken;
  auto apart = goes_each_way();
  if (apart && !*apart) {
    if (auto moved = move_somewhere(); !moved) return moved;
    apart = goes_each_way();
  }
  if (!apart) return tl::unexpected(apart.error());
  piece.is_apart = *apart;
  return drop(piece);
}

Result<void> PieceSeparator::take(const Piece& piece) {
  const CamAxes& grasp = board_->state().grasp;
  board_->place({piece.at[0] - grasp[0], piece.at[1] - grasp[1], piece.at[2] - grasp[2]});
  if (auto waited = wait_(); !waited) return waited;
  if (auto done = act(PieceAction::Select, PieceOutcome::Selected); !done) return done;
  if (board_->state().held != piece.number) {
    return tl::unexpected(disagreement("piece " + std::to_string(board_->state().held) +
                                       " is held instead of " + std::to_string(piece.number)));
  }
  return {};
}

Result<void> PieceSeparator::drop(Piece& piece) {
  piece.at = board_->state().grasp;
  return act(PieceAction::Drop, PieceOutcome::Dropped);
}

Result<void> PieceSeparator::act(PieceAction action, PieceOutcome expected) {
  board_->act(action, {});
  if (auto waited = wait_(); !waited) return waited;
  const auto outcome = board_->take_outcome();
  if (outcome == expected) return {};
  return tl::unexpected(disagreement(outcome ? std::string(to_string(*outcome)) : "no outcome"));
}

Result<CamAxes> PieceSeparator::go(const CamAxes& by) {
  const CamAxes before = board_->state().grasp;
  board_->move(by);
  if (auto waited = wait_(); !waited) return tl::unexpected(waited.error());
  const CamAxes& now = board_->state().grasp;
  return CamAxes{now[0] - before[0], now[1] - before[1], now[2] - before[2]};
}

// In one of the eight directions of a plane, within it.
Result<void> PieceSeparator::move_somewhere() {
  const CamAxes& grasp = board_->state().grasp;
  const int most = std::min(cells_[0], cells_[1]) / 4;
  const int cells = 1 + below(most);
  CamAxes by{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const int to = grasp[axis] + (below(3) - 1) * cells;
    by[axis] = std::clamp(to, 0, cells_[axis] - 1) - grasp[axis];
  }
  ++report_.moves;
  const auto gone = go(by);
  if (!gone) return tl::unexpected(gone.error());
  if (*gone != by) ++report_.blocked;
  return {};
}

// Of the held piece, which ends where it was.
Result<bool> PieceSeparator::goes_each_way() {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (const int way : {-1, 1}) {
      CamAxes by{};
      by[axis] = way;
      const int to = board_->state().grasp[axis] + way;
      if (to < 0 || to >= cells_[axis]) continue;
      const auto gone = go(by);
      if (!gone) return tl::unexpected(gone.error());
      if (*gone != by) return false;
      const CamAxes back{-by[0], -by[1], -by[2]};
      const auto returned = go(back);
      if (!returned) return tl::unexpected(returned.error());
      if (*returned != back) return tl::unexpected(disagreement("a piece cannot go back"));
    }
  }
  return true;
}

Result<void> PieceSeparator::look(Piece& piece) {
  if (auto taken = take(piece); !taken) return taken;
  const auto apart = goes_each_way();
  if (!apart) return tl::unexpected(apart.error());
  piece.is_apart = *apart;
  return drop(piece);
}

Result<pieces::PieceLayout> separator_layout(std::uint64_t seed) {
  return interlocking_layout(kSeparatorSpace, 4, seed);
}

Result<std::string> report_separator(std::uint64_t seed) {
  sim::VirtualClock clock;
  sim::cam::SimCamBoard slot(
      clock, {.shape = {{2, 2, 2}, 11}, .window_bytes = std::size_t{1} << 20, .is_paced = false});
  const auto layout = separator_layout(seed);
  if (!layout) return tl::unexpected(layout.error());
  pieces::PieceBoard board(
      [&](MonotonicTime now) -> Result<std::unique_ptr<CamBoard>> {
        auto port = cambus::PciPort::open(slot.open_window(), now, cambus::kMemoryTurn);
        if (!port) return tl::unexpected(port.error());
        return std::make_unique<cambus::Board>(*std::move(port));
      },
      {.space = kSeparatorSpace}, *layout, {1, 1, 0});
  const auto wait = [&]() -> Result<void> {
    do {
      board.pump(clock);
      if (board.trouble()) return tl::unexpected(*board.trouble());
    } while (!board.is_ready());
    return {};
  };
  if (const auto ready = wait(); !ready) return tl::unexpected(ready.error());
  const auto done = PieceSeparator(board, *layout, seed, wait).run(kMostMoves);
  if (!done) return tl::unexpected(done.error());
  auto& machine = slot.board().machine();
  std::string text =
      std::to_string(done->pieces) +
      " interlocking pieces in 128 x 128 cells: " + std::to_string(done->apart) + " apart after " +
      std::to_string(done->moves) + " moves (" + std::to_string(done->blocked) +
      " of them blocked),\n" + std::to_string(machine.counters().scans) + " scans and " +
      std::to_string(machine.now_clocks() / 25'000'000) + " s of a board at 25 MHz.\n";
  if (done->apart < done->pieces) return fail(Errc::System, std::move(text));
  return text;
}

}  // namespace thimble::lab
