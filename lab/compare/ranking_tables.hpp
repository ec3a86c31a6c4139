#pragma once

#include <span>
#include <string>
#include <vector>

#include "lab/compare/ranking.hpp"
#include "lab/findings/findings.hpp"

// The places of schemes at each delay, as tables for people and files. Pure.
namespace thimble::lab {

struct DelayMarks {
  double delay_s{0};
  std::vector<NetworkMarks> schemes;  // as many as there are names, in their order
  // The same schemes by other readings, in the order of the names that ranking_table() is given.
  std::vector<std::vector<NetworkMarks>> beside{};
};

// On how many networks each gate is failed, "passive:2 smooth:1"; "-" where none is.
[[nodiscard]] std::string failed_gates(const NetworkMarks& networks);

// A row for each scheme at each delay, the best first. `readings`: a column each, with the place by
// that reading.
[[nodiscard]] Table ranking_table(std::span<const std::string> names,
                                  std::span<const DelayMarks> delays,
                                  std::span<const std::string> readings = {});
// The same rows; a column for each metric has the place where that metric is left out.
[[nodiscard]] Table left_out_table(std::span<const std::string> names,
                                   std::span<const DelayMarks> delays);

}  // namespace thimble::lab
