#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/world/cam/piece_search.hpp"
#include "hal/base/result.hpp"
#include "hal/device/cam_board.hpp"

// The thesis's haptic latencies on a CAM-8 (4.2.1, 4.2.2), out of the simulated board's clocks.
namespace thimble::lab {

// How a haptic update is done.
struct CamLatencyCase {
  std::string name;
  int log2_modules{3};
  CamAxes log2_cells{9, 9, 0};
  int cell_width{1};  // in cells of the thesis's plane: the workspace is as wide
  world::cam::SearchKind search{world::cam::SearchKind::OneCell};
  bool counts_apart{true};  // a scan to shift, and one to count
  int updates_per_picture{1};
  double thesis_s{0};  // 0: the thesis has none
  int clock_mhz{25};   // of the board
  int held_cells{0};   // along each edge of the piece that is held; 0: none, the grasp point alone
};

// What one update takes, from step lists played by the board at its own pace.
struct CamLatencyRun {
  int cells{0};
  std::uint64_t scans{0};
  std::uint64_t lists{0};
  std::uint64_t clocks{0};  // of the board, the host's waiting included
  double time_s{0};         // of the update, host and board
  double picture_s{0};      // of one on the monitor, with the wait for its frame: the mean
  double latency_s{0};      // with picture and network
  double offset_m{0};       // at kHandSpeed_m_s
};

// Thesis 4.2.1: what its offsets were divided by.
inline constexpr double kHandSpeed_m_s = 0.2;
// Thesis 4.2.2: until the next frame boundary, on average. Only to compare with.
inline constexpr double kThesisPicture_s = 0.033;
// Thesis 4.2: round trip of a datagram.
inline constexpr double kNetwork_s = 0.001;
inline constexpr double kTolerance_percent = 10;

// Fitted, the same for all three.
struct CamLatencyFit {
  int cells{0};           // of the plane, that the grasp point moves in an update
  double host_cost_s{0};  // Forth and system calls of the thesis's host
};

// The three of the thesis, then ours in the same plane, and in space.
[[nodiscard]] std::vector<CamLatencyCase> cam_latency_cases(int clock_mhz = 25);

// An update ends anywhere in a frame of the monitor: so many moments, evenly apart, are tried.
inline constexpr int kPictures = 8;

// Moves the grasp point, or the piece in the middle, as far as the fit says along x through free
// space, which has to have four thirds of it; tables that searches need only once after each
// action are there. Deterministic. Errors: the board's.
[[nodiscard]] Result<CamLatencyRun> run_cam_latency(const CamLatencyCase& of,
                                                    const CamLatencyFit& fit);

// What a short stroke takes, with a host that costs nothing and with one that does. The cost of a
// list counts only where no scan runs meanwhile.
struct CamLatencyProbe {
  static constexpr int kCells = 4;
  static constexpr double kHost_s = 1e-4;
  CamLatencyCase of;
  double free_s{0};
  double paid_s{0};
  double picture_s{0};  // as CamLatencyRun, with a host that costs nothing
};
[[nodiscard]] Result<CamLatencyProbe> probe_cam_latency(const CamLatencyCase& of);

// The fit whose worst error against the thesis is least, among whole cells and hundredths of a
// millisecond, if looks take as long as in the probes. Pure.
[[nodiscard]] CamLatencyFit fit_cam_latency(const std::vector<CamLatencyProbe>& probes);

// Looks that a stroke of so many free cells takes. Pure.
[[nodiscard]] int looks_of(int cells, bool leaps) noexcept;

struct CamLatencyRow {
  CamLatencyCase of;
  CamLatencyRun run;
};
struct CamLatencyReport {
  std::string text;       // a table, for people
  bool is_within{false};  // each of the thesis's by kTolerance_percent
};
// What such rows say, at least one, with the fit that they were run with. Pure.
[[nodiscard]] CamLatencyReport tell_cam_latency(const CamLatencyFit& fit,
                                                const std::vector<CamLatencyRow>& rows);
// All of cam_latency_cases(), with the fit found first. Takes a second. Errors: the board's.
[[nodiscard]] Result<CamLatencyReport> report_cam_latency(int clock_mhz = 25);

}  // namespace thimble::lab
