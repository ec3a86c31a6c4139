#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

// A board for cellular automata as its programs see it, whatever it is made of and wherever it is
// plugged in. Words are those of the CAM-8's manual (docs/cambus.md): a site has a bit in each of
// 16 layers, a table of 65,536 entries says what becomes of a site, a kick moves layers.
namespace thimble {

inline constexpr std::size_t kCamLayers = 16;
inline constexpr std::size_t kCamTableEntries = 65'536;

// Along x, y, z.
using CamAxes = std::array<int, 3>;
// Layer n is bit n.
using CamLayers = std::uint16_t;
// Of a whole space, x first, then y, then z; bit n is layer n's.
using CamCells = std::vector<std::uint16_t>;
// Entry n is for the site with the bits of n; of kCamTableEntries.
using CamTable = std::vector<std::uint16_t>;

// How the cells of a space are divided among the modules of a board: over their torus as it is
// wired, or in strips along one axis.
enum class CamDivision : std::uint8_t { Mesh, StripX, StripY, StripZ };

// A space: powers of two, and each axis wraps.
struct CamGeometry {
  CamAxes log2_cells{};
  CamDivision division{CamDivision::StripY};  // as the CAM-8's software does
  [[nodiscard]] std::size_t cells() const noexcept {
    return std::size_t{1} << (log2_cells[0] + log2_cells[1] + log2_cells[2]);
  }
  bool operator==(const CamGeometry&) const = default;
};

// Some cells of a space: so many along each axis from one of them on, around its edges.
struct CamBox {
  CamAxes first{};
  CamAxes cells{1, 1, 1};
  bool operator==(const CamBox&) const = default;
};

struct CamKick {
  CamLayers layers{0};
  CamAxes cells{};  // +1 moves what is in these layers by one cell
};

// What a run does, in this order: counts, tables, kick, scan.
struct CamRun {
  bool is_scan{true};        // else only what follows is done
  bool takes_counts{false};  // copies the event counters to where they are read, and clears them
  bool swaps_tables{false};  // the table loaded last becomes the one in force
  bool repeats_kick{false};  // moves what moved with the last scan once more
};

// What is counted of each layer: nothing, its bit before the table, or after.
enum class CamEvents : std::uint8_t { None, Site, Table };

// The steps of a program. Tables, fixed layers and what is counted hold for all programs that
// follow; what it is within does not.
namespace cam_step {
// Moves layers with the next scan, and only with it; layers that are not named stand still. No
// further than a module is long, on an axis that is divided.
struct Kick {
  std::vector<CamKick> kicks;
};
// Into the table that is not in force; shared with who loads it often.
struct LoadTable {
  std::shared_ptr<const CamTable> table;
};
// The table is told these constants instead of the bits of some layers; the sites keep theirs.
struct Fix {
  CamLayers layers{0};
  std::uint16_t bits{0};
};
struct Count {
  CamEvents what{CamEvents::None};
  CamLayers layers{0xffff};  // of others nothing is counted
};
struct Run {
  CamRun options;
};
// The scans of this program that follow need visit these cells alone; nothing: all. A board visits
// as many more as suit it, so the table must change and count nothing elsewhere; and layers that
// are kicked must be empty elsewhere, before the kick and after it: what else is in them may be
// torn where modules meet.
struct Within {
  std::optional<CamBox> box;
};
// What the last run that took counts copied.
struct ReadCounts {};
// All cells. Neither can come between a kick and its scan, nor counts anything.
struct WriteCells {
  std::shared_ptr<const CamCells> cells;
};
struct ReadCells {};
// A slice of the space, by its number along z, on the monitor of a board that has one, once: the
// rest of its frame and as many lines as there are rows, two frames of a 60th of a second at most.
// Of 512 rows of 512 cells at most, none divided among modules along x. Changes and counts nothing;
// like the two above it cannot come between a kick and its scan.
struct Show {
  int slice{0};
};
}  // namespace cam_step
using CamStep = std::variant<cam_step::Kick, cam_step::LoadTable, cam_step::Fix, cam_step::Count,
                             cam_step::Run, cam_step::Within, cam_step::ReadCounts,
                             cam_step::WriteCells, cam_step::ReadCells, cam_step::Show>;
using CamSteps = std::vector<CamStep>;

// Of the layers, over all modules.
using CamCounts = std::array<std::uint64_t, kCamLayers>;

// What a program has read: in the order of its steps.
struct CamAnswer {
  std::vector<CamCounts> counts;
  std::vector<CamCells> cells;
};

struct CamBoardInfo {
  int modules{0};
  int log2_module_sites{0};
  std::uint32_t clock_hz{0};
};

struct CamBoardCounters {
  std::uint64_t started{0};
  std::uint64_t done{0};
  std::uint64_t failed{0};   // begun, and not known to be done
  std::uint64_t refused{0};  // no board saw them
  bool operator==(const CamBoardCounters&) const = default;
};

// A board, opened. Programs run one after the other; who starts one asks until it is over and
// waits for nothing.
//
// A program that failed may have been done in part. Sites keep what they had, or what a scan made
// of it; but tables, kicks and fixed layers are lost, and lay_out() has to be called again: after
// it, layers that had been kicked are found away from where they were.
//
// Thread: one, a world's; never the servo's: a simulated board does a scan in the thread that
// asks. Not RT. Ownership: owns its bus device. Times are of one clock, the caller's.
// Errors: Disconnected is for good: only opening the board again finds it.
class CamBoard {
 public:
  virtual ~CamBoard() = default;

  [[nodiscard]] virtual const CamBoardInfo& info() const noexcept = 0;
  // The space of the programs that follow, whose first one sets up every register: nothing moves,
  // every bit goes through the table, nothing is counted.
  // Errors: InvalidArgument, the space does not fit the board; Busy, a program runs.
  [[nodiscard]] virtual Result<void> lay_out(const CamGeometry& geometry) = 0;
  // At the start, and after every program that failed.
  [[nodiscard]] virtual bool needs_lay_out() const noexcept = 0;
  // `at_most`: the program is given up, and poll() says so, when it is not over by then.
  // Errors, and the board sees nothing: InvalidArgument for a step that cannot be on this space,
  // or before lay_out(); TooLarge, the program does not fit the board's memory, or a slice its
  // monitor; Unsupported, the board shows nothing; Busy; Disconnected.
  [[nodiscard]] virtual Result<void> start(const CamSteps& steps, Duration at_most,
                                           MonotonicTime now) = 0;
  // Nothing while it runs; what it has read, once, when it is over. Never waits.
  // Errors, each once, and then no program runs: Timeout (no module answered, or not in time),
  // System (the machine interrupted), Malformed (the board says what cannot be, or could not read
  // what it was given), Disconnected, InvalidArgument (no program runs).
  [[nodiscard]] virtual Result<std::optional<CamAnswer>> poll(MonotonicTime now) = 0;
  [[nodiscard]] virtual bool is_running() const noexcept = 0;
  [[nodiscard]] virtual const CamBoardCounters& counters() const noexcept = 0;
};

}  // namespace thimble
