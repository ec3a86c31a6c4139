#include "lab/cam_latency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "daemon/world/cam/piece_board.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "drivers/cambus/video_timing.hpp"
#include "hal/device/wrapped_cam_board.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::lab {
namespace {

namespace pieces = world::cam;

// How often the host looks. Ours: short beside a list, and beside what a poll over SBus took.
constexpr Duration kLook = std::chrono::microseconds(2);
// Beyond that of a module with all of the thesis's cells, at the slowest clock: 14.3 ms.
constexpr Duration kLongestScan = std::chrono::milliseconds(20);

// A host that needs some time before each list.
class SlowHost final : public WrappedCamBoard {
 public:
  SlowHost(std::unique_ptr<CamBoard> board, Duration cost)
      : WrappedCamBoard(std::move(board)), cost_(cost) {}
  [[nodiscard]] Result<void> start(const CamSteps& steps, Duration at_most,
                                   MonotonicTime now) override {
    steps_ = steps;
    at_most_ = at_most;
    starts_at_ = now + cost_;
    return {};
  }
  [[nodiscard]] Result<std::optional<CamAnswer>> poll(MonotonicTime now) override {
    if (starts_at_ && now < *starts_at_) return std::nullopt;
    if (starts_at_) {
      starts_at_.reset();
      const auto started = WrappedCamBoard::start(steps_, at_most_, now);
      if (!started) return tl::unexpected(started.error());
    }
    return WrappedCamBoard::poll(now);
  }
  [[nodiscard]] bool is_running() const noexcept override {
    return starts_at_.has_value() || WrappedCamBoard::is_running();
  }

 private:
  Duration cost_;
  CamSteps steps_;
  Duration at_most_{};
  std::optional<MonotonicTime> starts_at_;
};

// Along the torus of eight modules as it was: 2 x 2 x 2, or half of it.
[[nodiscard]] sim::cam::TorusShape torus(int log2_modules) {
  sim::cam::TorusShape shape{{1, 1, 1}, 22};
  for (int i = 0; i < log2_modules; ++i) shape.modules[static_cast<std::size_t>(i)] = 2;
  return shape;
}

[[nodiscard]] double fixed_s(const CamLatencyCase& of, double picture_s) {
  return picture_s / of.updates_per_picture + kNetwork_s;
}

[[nodiscard]] CamGeometry space_of(const CamLatencyCase& of) noexcept {
  return {of.log2_cells, CamDivision::StripY};
}

// A stroke along x stays within the space, and a held piece crosses modules; a grasp point alone
// may be anywhere.
[[nodiscard]] CamAxes start_of(const CamLatencyCase& of) noexcept {
  const CamAxes cells = pieces::cells_along(space_of(of));
  return {of.held_cells > 0 ? cells[0] / 2 : cells[0] / 4, cells[1] / 2, cells[2] / 2};
}

[[nodiscard]] bool leaps(const CamLatencyCase& of) noexcept {
  return of.search == pieces::SearchKind::Leap;
}

[[nodiscard]] bool sweeps(const CamLatencyCase& of) noexcept {
  return !leaps(of) && of.search != pieces::SearchKind::OneCell;
}

// A piece around the start, if one is to be held.
[[nodiscard]] pieces::PieceLayout layout_of(const CamLatencyCase& of) {
  const CamGeometry space = space_of(of);
  const CamAxes middle = start_of(of);
  const int edge = of.held_cells;
  pieces::PieceLayout layout(space.cells());
  const int deep = of.log2_cells[2] > 0 ? edge : std::min(edge, 1);
  for (int z = 0; z < deep; ++z) {
    for (int y = 0; y < edge; ++y) {
      for (int x = 0; x < edge; ++x) {
        const CamAxes cell{middle[0] + x - edge / 2, middle[1] + y - edge / 2,
                           middle[2] + z - deep / 2};
        layout[pieces::index_of(space, cell)] = 1;
      }
    }
  }
  return layout;
}

class Stroke {
 public:
  Stroke(const CamLatencyCase& of, const CamLatencyFit& fit)
      : clock_hz_(static_cast<std::uint32_t>(of.clock_mhz) * 1'000'000),
        slot_(clock_, {.shape = torus(of.log2_modules),
                       .clock_hz = clock_hz_,
                       .window_bytes = std::size_t{1} << 22}),
        cost_(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(fit.host_cost_s))),
        board_([this](MonotonicTime now) { return open(now); },
               {.space = space_of(of), .search = of.search, .counts_apart = of.counts_apart},
               layout_of(of), start_of(of)),
        is_held_(of.held_cells > 0),
        log2_rows_(of.log2_cells[1]),
        has_table_(!sweeps(of)) {}

  [[nodiscard]] Result<CamLatencyRun> run(int cells) {
    if (const auto ready = prepare(); !ready) return tl::unexpected(ready.error());
    auto& machine = slot_.board().machine();
    slot_.serve();
    const auto counters = machine.counters();
    const auto clocks = machine.now_clocks();
    const auto lists = board_.counters().programs;
    const MonotonicTime before = clock_.now();
    board_.move({cells, 0, 0});
    if (const auto ready = wait(); !ready) return tl::unexpected(ready.error());
    CamLatencyRun run;
    run.cells = cells;
    run.scans = machine.counters().scans - counters.scans;
    run.lists = board_.counters().programs - lists;
    run.clocks = machine.now_clocks() - clocks;
    run.time_s = std::chrono::duration<double>(clock_.now() - before).count();
    const auto picture = show_often(1 << log2_rows_);
    if (!picture) return tl::unexpected(picture.error());
    run.picture_s = *picture;
    return run;
  }

 private:
  // The mean of what a picture takes that begins in the middle of each eighth of a frame. The one
  // before it ends with the last of its rows.
  [[nodiscard]] Result<double> show_often(int rows) {
    const auto video = cambus::video_timing(clock_hz_);
    if (!video) return fail(Errc::Unsupported, "at this clock the board shows nothing");
    const double line_s = static_cast<double>(video->line_clocks()) / clock_hz_;
    const double frame_s = static_cast<double>(video->frame_clocks()) / clock_hz_;
    Duration sum{};
    for (int i = -1; i < kPictures; ++i) {
      const double wait_s = frame_s - rows * line_s + (i + 0.5) / kPictures * frame_s;
      if (i >= 0)
        clock_.run_for(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(wait_s)));
      const MonotonicTime before = clock_.now();
      board_.show();
      if (const auto ready = wait(); !ready) return tl::unexpected(ready.error());
      if (board_.why_dark()) return tl::unexpected(*board_.why_dark());
      if (i >= 0) sum += clock_.now() - before;
    }
    return std::chrono::duration<double>(sum).count() / kPictures;
  }
  // Holds the piece, and has the tables where they stay.
  [[nodiscard]] Result<void> prepare() {
    if (auto ready = wait(); !ready) return ready;
    if (is_held_) board_.act(pieces::PieceAction::Select, {});
    if (auto ready = wait(); !ready || has_table_) return ready;
    for (const int cell : {-1, 1}) {
      board_.move({cell, 0, 0});
      if (auto ready = wait(); !ready) return ready;
    }
    clock_.run_for(kLongestScan);
    return {};
  }
  [[nodiscard]] Result<std::unique_ptr<CamBoard>> open(MonotonicTime now) {
    auto port = cambus::PciPort::open(slot_.open_window(), now, cambus::kMemoryTurn);
    if (!port) return tl::unexpected(port.error());
    return std::make_unique<SlowHost>(std::make_unique<cambus::Board>(*std::move(port)), cost_);
  }
  [[nodiscard]] Result<void> wait() {
    while (true) {
      board_.pump(clock_);
      if (board_.trouble()) return tl::unexpected(*board_.trouble());
      if (board_.is_ready()) return {};
      clock_.run_for(kLook);
    }
  }

  sim::VirtualClock clock_;
  std::uint32_t clock_hz_;
  sim::cam::SimCamBoard slot_;
  Duration cost_;
  pieces::PieceBoard board_;
  bool is_held_;
  int log2_rows_;
  bool has_table_;  // that the search needs
};

// From the thesis's latency; 0 where it has none.
[[nodiscard]] double off_percent(const CamLatencyRow& row) {
  return row.of.thesis_s > 0 ? 100 * (row.run.latency_s / row.of.thesis_s - 1) : 0;
}

[[nodiscard]] std::string line(const CamLatencyRow& row) {
  const CamLatencyCase& of = row.of;
  const CamLatencyRun& run = row.run;
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "%-38s %5d %5llu %5llu %8llu %5.1f / %d %7.1f %6.1f",
                of.name.c_str(), run.cells, static_cast<unsigned long long>(run.scans),
                static_cast<unsigned long long>(run.lists),
                static_cast<unsigned long long>(run.clocks), 1e3 * run.picture_s,
                of.updates_per_picture, 1e3 * run.latency_s, 1e3 * run.offset_m);
  std::string out = text.data();
  if (of.thesis_s > 0) {
    std::snprintf(text.data(), text.size(), " %8.0f ms %4.0f mm %+5.1f %%", 1e3 * of.thesis_s,
                  1e3 * of.thesis_s * kHandSpeed_m_s, off_percent(row));
    out += text.data();
  }
  return out + '\n';
}

}  // namespace

std::vector<CamLatencyCase> cam_latency_cases(int clock_mhz) {
  using Kind = pieces::SearchKind;
  constexpr CamAxes kPlane{9, 9, 0};
  constexpr CamAxes kSpace{6, 6, 6};
  constexpr int kWide = 1 << (kPlane[0] - kSpace[0]);
  // SOURCE: ours; a piece as wide as random_layout() makes them with some hundred of them.
  constexpr int kPiece = 32;
  constexpr int kBody = 12;
  const auto ours = [=](const CamAxes& cells, const char* name, Kind search, int held) {
    const int wide = 1 << (kPlane[0] - cells[0]);
    return CamLatencyCase{name, 3, cells, wide, search, false, 7, 0, clock_mhz, held};
  };
  return {
      {"4 boards", 2, kPlane, 1, Kind::OneCell, true, 1, 0.250, clock_mhz},
      {"8 boards", 3, kPlane, 1, Kind::OneCell, true, 1, 0.125, clock_mhz},
      {"8 boards, leap", 3, kPlane, 1, Kind::Leap, true, 7, 0.035, clock_mhz},
      ours(kPlane, "8 boards, leap, one scan a look", Kind::Leap, 0),
      ours(kPlane, "8 boards, trail", Kind::Sweep, 0),
      ours(kPlane, "8 boards, trail in its box", Kind::BoundedSweep, 0),
      ours(kPlane, "a piece of 32 x 32, leap", Kind::Leap, kPiece),
      ours(kPlane, "a piece of 32 x 32, trail", Kind::Sweep, kPiece),
      ours(kPlane, "a piece of 32 x 32, trail in its box", Kind::BoundedSweep, kPiece),
      {"64^3, 8 boards", 3, kSpace, kWide, Kind::OneCell, true, 1, 0, clock_mhz},
      {"64^3, 8 boards, leap", 3, kSpace, kWide, Kind::Leap, true, 7, 0, clock_mhz},
      ours(kSpace, "64^3, 8 boards, leap, one scan a look", Kind::Leap, 0),
      ours(kSpace, "64^3, 8 boards, trail", Kind::Sweep, 0),
      ours(kSpace, "64^3, 8 boards, trail in its box", Kind::BoundedSweep, 0),
      ours(kSpace, "64^3, a piece of 12^3, leap", Kind::Leap, kBody),
      ours(kSpace, "64^3, a piece of 12^3, trail", Kind::Sweep, kBody),
      ours(kSpace, "64^3, a piece of 12^3, trail in box", Kind::BoundedSweep, kBody),
  };
}

int looks_of(int cells, bool leaps) noexcept { return leaps ? cells / 4 + cells % 4 : cells; }

Result<CamLatencyRun> run_cam_latency(const CamLatencyCase& of, const CamLatencyFit& fit) {
  auto run = Stroke(of, fit).run((fit.cells + of.cell_width - 1) / of.cell_width);
  if (!run) return run;
  run->latency_s = run->time_s + fixed_s(of, run->picture_s);
  run->offset_m = run->latency_s * kHandSpeed_m_s;
  return run;
}

Result<CamLatencyProbe> probe_cam_latency(const CamLatencyCase& of) {
  const auto free = run_cam_latency(of, {CamLatencyProbe::kCells, 0});
  if (!free) return tl::unexpected(free.error());
  const auto paid = run_cam_latency(of, {CamLatencyProbe::kCells, CamLatencyProbe::kHost_s});
  if (!paid) return tl::unexpected(paid.error());
  return CamLatencyProbe{of, free->time_s, paid->time_s, free->picture_s};
}

CamLatencyFit fit_cam_latency(const std::vector<CamLatencyProbe>& probes) {
  CamLatencyFit best;
  double least = std::numeric_limits<double>::infinity();
  for (int cells = 1; cells <= 100; ++cells) {
    for (int cost = 0; cost <= 50; ++cost) {
      const double host_s = cost * 1e-5;
      double worst = 0;
      for (const CamLatencyProbe& probe : probes) {
        if (probe.of.thesis_s <= 0) continue;
        const int looks = looks_of(CamLatencyProbe::kCells, leaps(probe.of));
        const double slope = (probe.paid_s - probe.free_s) / CamLatencyProbe::kHost_s;
        const double look_s = (probe.free_s + slope * host_s) / looks;
        const double latency_s =
            looks_of(cells, leaps(probe.of)) * look_s + fixed_s(probe.of, probe.picture_s + host_s);
        worst = std::max(worst, std::abs(latency_s / probe.of.thesis_s - 1));
      }
      if (worst >= least) continue;
      least = worst;
      best = {cells, host_s};
    }
  }
  return best;
}

CamLatencyReport tell_cam_latency(const CamLatencyFit& fit,
                                  const std::vector<CamLatencyRow>& rows) {
  CamLatencyReport report{"", true};
  std::array<char, 600> text{};
  std::snprintf(
      text.data(), text.size(),
      "At %d MHz, in virtual time: 512 x 512 cells, and 64 x 64 x 64 whose cells are 8 "
      "times as wide.\nFitted, the same for all: %d cells of the plane an update, %.2f "
      "ms of host a list.\nA picture on the monitor, with the wait for its frame, comes once "
      "in 1 or 7 updates; the thesis has %.0f ms for it.\nFrom the thesis: %.0f ms of "
      "network.\n\n%-38s %5s %5s %5s %8s %9s %7s %6s %s\n",
      rows.front().of.clock_mhz, fit.cells, 1e3 * fit.host_cost_s, 1e3 * kThesisPicture_s,
      1e3 * kNetwork_s, "", "cells", "scans", "lists", "clocks", "picture", "ms", "mm",
      "     the thesis");
  report.text = text.data();
  for (const CamLatencyRow& row : rows) {
    report.text += line(row);
    report.is_within = report.is_within && std::abs(off_percent(row)) <= kTolerance_percent;
  }
  return report;
}

Result<CamLatencyReport> report_cam_latency(int clock_mhz) {
  const auto cases = cam_latency_cases(clock_mhz);
  std::vector<CamLatencyProbe> probes;
  for (const CamLatencyCase& of : cases) {
    if (of.thesis_s <= 0) continue;  // nothing to fit
    const auto probe = probe_cam_latency(of);
    if (!probe) return tl::unexpected(probe.error());
    probes.push_back(*probe);
  }
  const CamLatencyFit fit = fit_cam_latency(probes);
  std::vector<CamLatencyRow> rows;
  for (const CamLatencyCase& of : cases) {
    const auto run = run_cam_latency(of, fit);
    if (!run) return tl::unexpected(run.error());
    rows.push_back({of, *run});
  }
  return tell_cam_latency(fit, rows);
}

}  // namespace thimble::lab
