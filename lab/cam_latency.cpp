#include "lab/cam_latency.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "daemon/world/cam/piece_board.hpp"
#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
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
class SlowHost final : public CamBoard {
 public:
  SlowHost(std::unique_ptr<CamBoard> board, Duration cost)
      : board_(std::move(board)), cost_(cost) {}
  [[nodiscard]] const CamBoardInfo& info() const noexcept override { return board_->info(); }
  [[nodiscard]] Result<void> lay_out(const CamGeometry& geometry) override {
    return board_->lay_out(geometry);
  }
  [[nodiscard]] bool needs_lay_out() const noexcept override { return board_->needs_lay_out(); }
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
      const auto started = board_->start(steps_, at_most_, now);
      if (!started) return tl::unexpected(started.error());
    }
    return board_->poll(now);
  }
  [[nodiscard]] bool is_running() const noexcept override {
    return starts_at_.has_value() || board_->is_running();
  }
  [[nodiscard]] const CamBoardCounters& counters() const noexcept override {
    return board_->counters();
  }

 private:
  std::unique_ptr<CamBoard> board_;
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

[[nodiscard]] double fixed_s(const CamLatencyCase& of) {
  return kPicture_s / of.updates_per_picture + kNetwork_s;
}

[[nodiscard]] CamGeometry space_of(const CamLatencyCase& of) noexcept {
  return {of.log2_cells, CamDivision::StripY};
}

// A stroke along x stays within the space; the other axes are the same everywhere.
[[nodiscard]] CamAxes start_of(const CamLatencyCase& of) noexcept {
  return {1 << (of.log2_cells[0] - 2), (1 << of.log2_cells[1]) / 2, (1 << of.log2_cells[2]) / 2};
}

[[nodiscard]] bool leaps(const CamLatencyCase& of) noexcept {
  return of.search == pieces::SearchKind::Leap;
}

class Stroke {
 public:
  Stroke(const CamLatencyCase& of, const CamLatencyFit& fit)
      : slot_(clock_, {.shape = torus(of.log2_modules),
                       .clock_hz = static_cast<std::uint32_t>(of.clock_mhz) * 1'000'000,
                       .window_bytes = std::size_t{1} << 22}),
        cost_(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(fit.host_cost_s))),
        board_([this](MonotonicTime now) { return open(now); },
               {.space = space_of(of), .search = of.search, .counts_apart = of.counts_apart},
               pieces::PieceLayout(space_of(of).cells()), start_of(of)),
        has_table_(of.search != pieces::SearchKind::Sweep) {}

  [[nodiscard]] Result<CamLatencyRun> run(int cells) {
    if (const auto ready = begin(); !ready) return tl::unexpected(ready.error());
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
    return run;
  }

 private:
  // The table of a trail goes to the board with the first update alone, which is not counted.
  [[nodiscard]] Result<void> begin() {
    auto ready = wait();
    if (!ready || has_table_) return ready;
    board_.move({1, 0, 0});
    ready = wait();
    clock_.run_for(kLongestScan);
    return ready;
  }
  [[nodiscard]] Result<std::unique_ptr<CamBoard>> open(MonotonicTime now) {
    auto port = cambus::PciPort::open(slot_.open_window(), now);
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
  sim::cam::SimCamBoard slot_;
  Duration cost_;
  pieces::PieceBoard board_;
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
  std::snprintf(text.data(), text.size(), "%-38s %5d %5llu %5llu %8llu %8d %7.1f %6.1f",
                of.name.c_str(), run.cells, static_cast<unsigned long long>(run.scans),
                static_cast<unsigned long long>(run.lists),
                static_cast<unsigned long long>(run.clocks), of.updates_per_picture,
                1e3 * run.latency_s, 1e3 * run.offset_m);
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
  return {
      {"4 boards", 2, kPlane, 1, Kind::OneCell, true, 1, 0.250, clock_mhz},
      {"8 boards", 3, kPlane, 1, Kind::OneCell, true, 1, 0.125, clock_mhz},
      {"8 boards, leap", 3, kPlane, 1, Kind::Leap, true, 7, 0.035, clock_mhz},
      {"8 boards, leap, one scan a look", 3, kPlane, 1, Kind::Leap, false, 7, 0, clock_mhz},
      {"8 boards, trail", 3, kPlane, 1, Kind::Sweep, false, 7, 0, clock_mhz},
      {"64^3, 8 boards", 3, kSpace, kWide, Kind::OneCell, true, 1, 0, clock_mhz},
      {"64^3, 8 boards, leap", 3, kSpace, kWide, Kind::Leap, true, 7, 0, clock_mhz},
      {"64^3, 8 boards, leap, one scan a look", 3, kSpace, kWide, Kind::Leap, false, 7, 0,
       clock_mhz},
      {"64^3, 8 boards, trail", 3, kSpace, kWide, Kind::Sweep, false, 7, 0, clock_mhz},
  };
}

int looks_of(int cells, bool leaps) noexcept { return leaps ? cells / 4 + cells % 4 : cells; }

Result<CamLatencyRun> run_cam_latency(const CamLatencyCase& of, const CamLatencyFit& fit) {
  auto run = Stroke(of, fit).run((fit.cells + of.cell_width - 1) / of.cell_width);
  if (!run) return run;
  run->latency_s = run->time_s + fixed_s(of);
  run->offset_m = run->latency_s * kHandSpeed_m_s;
  return run;
}

Result<CamLatencyProbe> probe_cam_latency(const CamLatencyCase& of) {
  const auto free = run_cam_latency(of, {CamLatencyProbe::kCells, 0});
  if (!free) return tl::unexpected(free.error());
  const auto paid = run_cam_latency(of, {CamLatencyProbe::kCells, CamLatencyProbe::kHost_s});
  if (!paid) return tl::unexpected(paid.error());
  return CamLatencyProbe{of, free->time_s, paid->time_s};
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
        const double latency_s = looks_of(cells, leaps(probe.of)) * look_s + fixed_s(probe.of);
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
  std::snprintf(text.data(), text.size(),
                "At %d MHz, in virtual time: 512 x 512 cells, and 64 x 64 x 64 whose cells are 8 "
                "times as wide.\nFitted, the same for all: %d cells of the plane an update, %.2f "
                "ms of host a list.\nFrom the thesis: %.0f ms to the picture, which comes once in "
                "so many updates as its column says; %.0f ms of network.\n\n%-38s %5s %5s %5s %8s "
                "%8s %7s %6s "
                "%s\n",
                rows.front().of.clock_mhz, fit.cells, 1e3 * fit.host_cost_s, 1e3 * kPicture_s,
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
    if (of.thesis_s <= 0) continue;
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
