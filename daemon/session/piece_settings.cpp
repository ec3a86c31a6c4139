#include "daemon/session/piece_settings.hpp"

#include <bit>
#include <utility>

#include "daemon/world/cam/piece_world.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"

namespace thimble::session {
namespace {

namespace pieces = world::cam;

[[nodiscard]] int log2_of(int power) noexcept {
  return std::countr_zero(static_cast<unsigned>(power));
}

// Modules of just the sites that the space needs.
[[nodiscard]] sim::cam::BoardOptions board_options(const config::PiecesConfig& said) {
  sim::cam::BoardOptions options;
  int left = log2_of(said.boards);
  options.shape.log2_sites = 2 * log2_of(said.cells) - left;
  for (auto& along : options.shape.modules) along = left-- > 0 ? 2 : 1;
  options.window_bytes = std::size_t{1} << 21;  // all cells there, or back, and a table
  options.is_paced = false;
  return options;
}

}  // namespace

Result<std::unique_ptr<world::World>> make_piece_world(const config::WorldConfig& said,
                                                       const Clock* clock) {
  const config::PiecesConfig& of = *said.pieces;
  if (clock == nullptr) {
    return fail(Errc::Unsupported, said.source + ": a world on a board needs a clock");
  }
  pieces::PieceWorldSettings settings;
  settings.pieces.space = {{log2_of(of.cells), log2_of(of.cells), 0}, CamDivision::StripY};
  settings.pieces.search = of.search == config::PieceSearch::Leap ? pieces::SearchKind::Leap
                                                                  : pieces::SearchKind::OneCell;
  settings.workspace_m = said.workspace_m;
  settings.source = said.source;
  auto layout = pieces::random_layout(settings.pieces.space, of.count, of.seed);
  if (!layout) return tl::unexpected(layout.error());
  const auto slot = std::make_shared<sim::cam::SimCamBoard>(*clock, board_options(of));
  const auto open = [slot](MonotonicTime now) -> Result<std::unique_ptr<CamBoard>> {
    auto port = cambus::PciPort::open(slot->open_window(), now);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  };
  auto world = pieces::PieceWorld::create(settings, open, *std::move(layout), *clock);
  if (!world) return tl::unexpected(world.error());
  return *std::move(world);
}

}  // namespace thimble::session
