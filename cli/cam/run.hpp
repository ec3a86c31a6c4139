#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/cambus/cambus_registers.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "sim/model/cam/cam_machine.hpp"
#include "sim/model/cam/engine/engine.hpp"
#include "sim/model/cam/rules/rule.hpp"

namespace thimble::cam {

using sim::cam::Rule;

// What `thimble cam run` was told.
struct RunOptions {
  std::string world{};
  std::string size{};  // "512x512" or "64x64x64": sites, powers of two
  std::uint64_t steps{0};
  std::uint64_t seed{1};
  std::string pattern{};  // a file; empty: at random
  std::string engine{"auto"};
  int modules{1};
  int clock_mhz{cambus::kClocks_mhz.back()};  // of the board: one of cambus::kClocks_mhz
  std::size_t threads{1};                     // of this machine, that share a scan
  std::string write{};                        // a file; empty: none
  bool is_json{false};
};

// "64x64x64" as powers of two. Errors: InvalidArgument. Pure and total.
[[nodiscard]] Result<sim::cam::SiteSpace> parse_size(const std::string& text);

// What came of it.
struct RunReport {
  sim::cam::PlaneCounts population{};
  sim::cam::PlaneCounts counters{};             // of the last step: bits behind the table
  std::string path{};                           // "board", "table", "compiled"
  std::string kernels{};                        // the instruction set; empty for the board
  std::optional<std::uint64_t> board_clocks{};  // of the steps alone; none: no such board
  std::uint64_t unmodelled{0};  // of what that board was told, without effect on a simulated one
  std::vector<sim::cam::UnmodelledTouch> unmodelled_touches{};
  double host_s{0};  // of the steps alone
  std::vector<std::uint16_t> sites{};
};

// A world's first sites. Errors: of the pattern's file, or where it does not fit.
[[nodiscard]] Result<std::vector<std::uint16_t>> first_sites(const Rule& rule,
                                                             const sim::cam::SiteSpace& space,
                                                             const RunOptions& options);
// What is under way, told before it begins: "step 3 of 10"; "" when all is done. Called on the
// caller's thread; may not throw. An empty function: nobody waits.
using Progress = std::function<void(const std::string& what)>;

// Tells of steps ten times a second at most, which is ours: what an eye follows. Errors: one
// sentence that names what was wrong.
[[nodiscard]] Result<RunReport> run_world(const Rule& rule, const sim::cam::SiteSpace& space,
                                          const RunOptions& options, const Clock& clock,
                                          const Progress& progress);

// A line each, for a person: which register, and when by the board's clock.
[[nodiscard]] std::string log_of(const std::vector<sim::cam::UnmodelledTouch>& touches);

// Sites as a file by the end of its name: .npy (16-bit numbers, [x, y, z]) or .rle (of a world in a
// plane: its cells, or the sites with anything of the rule's matter). Errors: InvalidArgument.
[[nodiscard]] Result<std::string> to_file(const Rule& rule, const sim::cam::SiteSpace& space,
                                          const std::vector<std::uint16_t>& sites,
                                          const std::string& name);

// `thimble cam run` and `thimble cam list`: to standard output, mistakes to standard error; the
// exit code.
int run_run(const RunOptions& options, const Clock& clock);
int run_list(bool is_json);

}  // namespace thimble::cam
