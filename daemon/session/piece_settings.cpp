#include "daemon/session/piece_settings.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "daemon/session/cam_boards.hpp"
#include "daemon/session/piece_file.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "drivers/cambus/video_timing.hpp"

namespace thimble::session {
namespace {

namespace pieces = world::cam;

// Ours: the longest program, 512 x 512 cells and a table, is 0.7 MB, and USB at full speed carries
// one a second.
constexpr Duration kUsbPatience = std::chrono::seconds(3);

[[nodiscard]] int log2_of(int power) noexcept {
  return std::countr_zero(static_cast<unsigned>(power));
}

[[nodiscard]] bool is_on_usb(config::PieceBoardKind board) noexcept {
  return board == config::PieceBoardKind::Usb || board == config::PieceBoardKind::SimUsb;
}

// Modules of just the sites that the space needs.
[[nodiscard]] sim::cam::BoardOptions board_options(const CamAxes& log2_cells, int boards,
                                                   const Clock& clock) {
  sim::cam::BoardOptions options;
  int left = log2_of(boards);
  options.shape.log2_sites = log2_cells[0] + log2_cells[1] + log2_cells[2] - left;
  for (auto& along : options.shape.modules) along = left-- > 0 ? 2 : 1;
  options.window_bytes = std::size_t{1} << 21;  // all cells there, or back, and a table
  options.is_paced = false;
  options.thread_clock = &clock;
  return options;
}

[[nodiscard]] Result<PieceFile> layout_of(const config::PiecesConfig& said) {
  if (said.layout) return read_piece_file(*said.layout);
  const int log2 = log2_of(said.cells);
  PieceFile file{{log2, log2, said.axes == 3 ? log2 : 0}, {}};
  auto layout =
      pieces::random_layout({file.log2_cells, CamDivision::StripY}, said.count, said.seed);
  if (!layout) return tl::unexpected(layout.error());
  file.layout = *std::move(layout);
  return file;
}

// Pieces of our own are thick enough for leaps; what somebody drew need not be.
[[nodiscard]] pieces::SearchKind search_of(const config::PiecesConfig& said) noexcept {
  if (said.search == config::PieceSearch::OneCell) return pieces::SearchKind::OneCell;
  const bool is_by_trail = said.layout || said.search == config::PieceSearch::Trail;
  return is_by_trail ? pieces::SearchKind::BoundedSweep : pieces::SearchKind::Leap;
}

// `made` has the plug of a simulated board.
[[nodiscard]] Result<pieces::PieceBoard::Opener> opener_for(const config::WorldConfig& said,
                                                            const CamAxes& log2_cells,
                                                            const Clock& clock,
                                                            const BoardPlugs& plugs,
                                                            MadeWorld& made) {
  const config::PiecesConfig& of = *said.pieces;
  if (of.board == config::PieceBoardKind::Usb) {
    if (plugs.buses != nullptr) return open_plugged_in(plugs);
    return fail(
        Errc::Unsupported,
        said.source + ": only a running daemon looks for a board on USB; use board = \"sim\"");
  }
  if (of.board == config::PieceBoardKind::Pci) {
    if (plugs.open_window) return open_in_real_slot(plugs);
    return fail(Errc::Unsupported, said.source +
                                       ": only a running daemon looks for a board in a "
                                       "slot; use board = \"sim\"");
  }
  if (log2_cells[1] <= log2_of(of.boards)) {
    return fail(Errc::InvalidArgument, said.source +
                                           ": boards: each takes two rows of cells at least, " +
                                           std::to_string(of.boards) + " of them " +
                                           std::to_string(2 * of.boards) + " along y");
  }
  const auto options = board_options(log2_cells, of.boards, clock);
  if (of.board == config::PieceBoardKind::Sim) return open_in_slot(clock, options);
  made.usb_board = std::make_shared<sim::cam::SimUsbCamBoard>(clock, options);
  return open_on_usb(made.usb_board);
}

}  // namespace

Result<MadeWorld> make_piece_world(const config::WorldConfig& said, const Clock* clock,
                                   const BoardPlugs& plugs) {
  const config::PiecesConfig& of = *said.pieces;
  if (clock == nullptr) {
    return fail(Errc::Unsupported, said.source + ": a world on a board needs a clock");
  }
  pieces::PieceWorldSettings settings;
  auto file = layout_of(of);
  if (!file) return tl::unexpected(file.error());
  const int most = of.is_dynamic ? pieces::kMostDynamicPieces : pieces::kMostPieces;
  const auto& numbers = file->layout;
  if (std::any_of(numbers.begin(), numbers.end(), [&](int number) { return number > most; })) {
    return fail(Errc::InvalidArgument, said.source + ": dynamic: pieces are numbered 1 to " +
                                           std::to_string(most) + " then");
  }
  const bool is_too_large =
      file->log2_cells[0] > cambus::kLog2LineSites || file->log2_cells[1] > cambus::kLog2Lines;
  if (of.display_every && is_too_large) {
    return fail(Errc::InvalidArgument,
                said.source + ": display_every: a monitor shows 512 rows of 512 cells at most");
  }
  settings.pieces.is_dynamic = of.is_dynamic;
  settings.pieces.moves_a_picture = of.display_every.value_or(0);
  settings.pieces.space = {file->log2_cells, CamDivision::StripY};
  settings.pieces.search = search_of(of);
  settings.workspace_m = said.workspace_m;
  settings.pressure.newton_per_m = of.pressure_newton_per_m.value_or(0);
  settings.source = said.source;
  MadeWorld made;
  auto open = opener_for(said, file->log2_cells, *clock, plugs, made);
  if (!open) return tl::unexpected(open.error());
  if (is_on_usb(of.board)) settings.pieces.patience = kUsbPatience;
  auto world =
      pieces::PieceWorld::create(settings, *std::move(open), std::move(file->layout), *clock);
  if (!world) return tl::unexpected(world.error());
  made.world = *std::move(world);
  return made;
}

}  // namespace thimble::session
