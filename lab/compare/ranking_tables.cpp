#include "lab/compare/ranking_tables.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace thimble::lab {
namespace {

// With each metric left out in turn.
using LeftOut = std::array<std::vector<Standing>, kMetrics>;

LeftOut rank_left_out(const std::vector<NetworkMarks>& schemes) {
  LeftOut standings;
  for (std::size_t metric = 0; metric < kMetrics; ++metric) {
    standings[metric] = rank(schemes, without(static_cast<Metric>(metric)));
  }
  return standings;
}

double place_in(std::span<const Standing> standings, std::size_t scheme) {
  return static_cast<double>(place_of(scheme, standings));
}

}  // namespace

std::string failed_gates(const NetworkMarks& networks) {
  std::string text;
  for (std::size_t gate = 0; gate < kGates; ++gate) {
    const auto fails = std::count_if(networks.begin(), networks.end(),
                                     [&](const Marks& m) { return m.fails[gate]; });
    if (fails == 0) continue;
    text += text.empty() ? "" : " ";
    text += std::string(to_string(static_cast<Gate>(gate))) + ":" + std::to_string(fails);
  }
  return text.empty() ? "-" : text;
}

Table ranking_table(std::span<const std::string> names, std::span<const DelayMarks> delays,
                    std::span<const std::string> readings) {
  Table table{.name = "ranking",
              .title =
                  "Places at each delay, over the four networks; beside them with equal "
                  "weights, the best and the worst with one metric left out, and by other readings",
              .columns = {{"delay", "ms", 0},
                          {"place", "", 0},
                          {"scheme", ""},
                          {"score", ""},
                          {"networks_failed", "", 0},
                          {"equal_weights", "", 0},
                          {"best_without_one", "", 0},
                          {"worst_without_one", "", 0},
                          {"gates_failed", ""}},
              .rows = {}};
  for (const std::string& reading : readings) table.columns.push_back({reading, "", 0});
  for (const DelayMarks& at : delays) {
    const auto standings = rank(at.schemes, kWeights);
    const auto equal = rank(at.schemes, kEqualWeights);
    const LeftOut left_out = rank_left_out(at.schemes);
    for (const Standing& standing : standings) {
      const std::size_t scheme = standing.scheme;
      const double place = place_in(standings, scheme);
      double best = place;
      double worst = place;
      for (const auto& others : left_out) {
        best = std::min(best, place_in(others, scheme));
        worst = std::max(worst, place_in(others, scheme));
      }
      table.rows.push_back({1e3 * at.delay_s, place, names[scheme], standing.score,
                            static_cast<double>(standing.failed), place_in(equal, scheme), best,
                            worst, failed_gates(at.schemes[scheme])});
      for (const auto& others : at.beside) {
        table.rows.back().emplace_back(place_in(rank(others, kWeights), scheme));
      }
    }
  }
  return table;
}

Table left_out_table(std::span<const std::string> names, std::span<const DelayMarks> delays) {
  Table table{.name = "left-out",
              .title = "Places with one metric left out, that of the column",
              .columns = {{"delay", "ms", 0}, {"scheme", ""}, {"place", "", 0}},
              .rows = {}};
  for (std::size_t metric = 0; metric < kMetrics; ++metric) {
    table.columns.push_back({std::string(to_string(static_cast<Metric>(metric))), "", 0});
  }
  for (const DelayMarks& at : delays) {
    const auto standings = rank(at.schemes, kWeights);
    const LeftOut left_out = rank_left_out(at.schemes);
    for (const Standing& standing : standings) {
      std::vector<Cell> row{1e3 * at.delay_s, names[standing.scheme],
                            place_in(standings, standing.scheme)};
      for (const auto& others : left_out) row.emplace_back(place_in(others, standing.scheme));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace thimble::lab
