// A haptic update of pieces on a simulated CAM board of eight modules that runs as fast as this
// computer can: the grasp point goes 35 cells, through list checks, window, registers and scans.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "bench/comparison.hpp"
#include "daemon/world/cam/piece_board.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "sim/model/cam/sim_cam_board.hpp"

namespace {

using namespace thimble;
namespace pieces = world::cam;

// SOURCE: about the stroke of an update that the thesis's latencies fit (lab/cam_latency.hpp).
constexpr int kCells = 35;
constexpr std::size_t kUpdates = 10;

class Table {
 public:
  Table(const CamGeometry& space, pieces::SearchKind search, const pieces::PieceLayout& layout)
      : Table(space, search, layout, start_in(space, layout)) {}
  Table(const CamGeometry& space, pieces::SearchKind search, const pieces::PieceLayout& layout,
        const CamAxes& grasp)
      : space_(space),
        slot_(clock_, options_for(space)),
        board_([this](MonotonicTime now) { return open(now); }, {.space = space_, .search = search},
               layout, grasp) {}

  // The piece below the grasp point.
  [[nodiscard]] bool hold() {
    if (!wait()) return false;
    board_.act(pieces::PieceAction::Select, {});
    return wait() && board_.state().held != 0;
  }

  // Microseconds of the least of so many; none when the board fails.
  [[nodiscard]] double update_us() {
    double least_us = 1e12;
    if (!wait()) return 0;
    for (std::size_t i = 0; i < kUpdates; ++i) {
      const MonotonicTime start = clock_.now();
      board_.move({i % 2 == 0 ? kCells : -kCells, 0, 0});
      if (!wait()) return 0;
      least_us = std::min(least_us, seconds(clock_.now() - start) * 1e6);
    }
    return least_us;
  }
  [[nodiscard]] bool is_all_fast() { return slot_.board().machine().counters().site_by_site == 0; }

 private:
  static sim::cam::BoardOptions options_for(const CamGeometry& space) {
    sim::cam::BoardOptions options{.shape = {{2, 2, 2}, 0}, .window_bytes = std::size_t{1} << 22};
    const CamAxes& log2 = space.log2_cells;
    options.shape.log2_sites = log2[0] + log2[1] + log2[2] - 3;
    options.is_paced = false;
    return options;
  }
  // A cell without a piece, so far to the left that the stroke stays within the space.
  static CamAxes start_in(const CamGeometry& space, const pieces::PieceLayout& layout) {
    const CamAxes cells = pieces::cells_along(space);
    CamAxes at{cells[0] / 4, 1, 0};
    while (layout[pieces::index_of(space, at)] != 0 && at[1] + 1 < cells[1]) ++at[1];
    return at;
  }
  [[nodiscard]] Result<std::unique_ptr<CamBoard>> open(MonotonicTime now) {
    auto port = cambus::PciPort::open(slot_.open_window(), now, cambus::kMemoryTurn);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<cambus::Board>(*std::move(port));
  }
  [[nodiscard]] bool wait() {
    do {
      board_.pump(clock_);
      if (board_.trouble()) return false;
    } while (!board_.is_ready());
    return true;
  }

  linux::MonotonicClock clock_;
  CamGeometry space_;
  sim::cam::SimCamBoard slot_;
  pieces::PieceBoard board_;
};

[[nodiscard]] bool measure(const std::string& name, const CamAxes& log2_cells,
                           pieces::SearchKind search, int count) {
  const CamGeometry space{log2_cells, CamDivision::StripY};
  const auto layout = pieces::random_layout(space, count, 1);
  if (!layout) return false;
  Table table(space, search, *layout);
  bench::Slices ours;
  for (std::size_t slice = 0; slice < bench::kSlices; ++slice) {
    ours.push_back(table.update_us());
    if (ours.back() <= 0) return false;
  }
  bench::print(bench::compare(name, "us", {bench::Goal::Of::Value, 1000}, ours, {}));
  return table.is_all_fast();
}

// Where a piece is held; a stroke from there stays within the space.
CamAxes grasp_in(const CamGeometry& space) { return {1 << (space.log2_cells[0] - 2), 1, 0}; }

// One piece, with grasp_in() in it.
pieces::PieceLayout one_piece(const CamGeometry& space, int edge) {
  pieces::PieceLayout layout(space.cells());
  const int first = grasp_in(space)[0] - edge / 2;
  const int deep = space.log2_cells[2] > 0 ? edge : std::min(edge, 1);
  for (int z = 0; z < deep; ++z) {
    for (int y = 0; y < edge; ++y) {
      for (int x = first; x < first + edge; ++x) {
        layout[pieces::index_of(space, {x, y, z})] = 1;
      }
    }
  }
  return layout;
}

// A held piece by its trail in the box around it, beside the same in the whole space.
[[nodiscard]] bool measure_box(const std::string& name, const CamAxes& log2_cells, int cells) {
  const CamGeometry space{log2_cells, CamDivision::StripY};
  const auto layout = one_piece(space, cells);
  Table bounded(space, pieces::SearchKind::BoundedSweep, layout, grasp_in(space));
  Table whole(space, pieces::SearchKind::Sweep, layout, grasp_in(space));
  if (!bounded.hold() || !whole.hold()) return false;
  bench::Slices ours;
  bench::Slices references;
  bench::alternate(
      bench::kSlices, [&] { ours.push_back(bounded.update_us()); },
      [&] { references.push_back(whole.update_us()); });
  bench::print(bench::compare(name, "us", {bench::Goal::Of::Ratio, 1}, ours, references));
  return bounded.is_all_fast() && whole.is_all_fast() &&
         *std::min_element(ours.begin(), ours.end()) > 0;
}

}  // namespace

int main() {
  using pieces::SearchKind;
  // An empty space by leaps, then pieces as in examples/pieces.toml and pieces-3d.toml by trails,
  // which files of layouts are searched by: the stroke ends where it meets one.
  if (measure("haptic update of pieces, 512^2", {9, 9, 0}, SearchKind::Leap, 0) &&
      measure("haptic update of pieces, 64^3", {6, 6, 6}, SearchKind::Leap, 0) &&
      measure("trail among 24 pieces, 512^2", {9, 9, 0}, SearchKind::BoundedSweep, 24) &&
      measure("trail among 12 pieces, 64^3", {6, 6, 6}, SearchKind::BoundedSweep, 12) &&
      measure_box("piece of 32^2 in its box, 512^2", {9, 9, 0}, 32) &&
      measure_box("piece of 12^3 in its box, 64^3", {6, 6, 6}, 12)) {
    return 0;
  }
  std::fputs("bench_cam_pieces: the board failed, or scanned site by site\n", stderr);
  return 1;
}
