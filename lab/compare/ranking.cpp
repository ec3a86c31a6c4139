#include "lab/compare/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace thimble::lab {

std::string_view to_string(Metric metric) noexcept {
  constexpr std::array<std::string_view, kMetrics> kNames{
      "onset",   "stiffness", "displacement", "drag",     "hold",
      "residue", "edge",      "missed_taps",  "recovery", "traffic"};
  return kNames[static_cast<std::size_t>(metric)];
}

std::string_view to_string(Gate gate) noexcept {
  constexpr std::array<std::string_view, kGates> kNames{"bounded", "passive", "smooth",
                                                        "not_attractive"};
  return kNames[static_cast<std::size_t>(gate)];
}

double bounded_mark(double value) noexcept {
  return std::isnan(value) ? kWorst : std::clamp(value, 0.0, kWorst);
}

Weights without(Metric metric) noexcept {
  Weights weights = kWeights;
  weights[static_cast<std::size_t>(metric)] = 0;
  return weights;
}

double score_of(const Marks& marks, const Weights& weights) noexcept {
  double sum = 0;
  double weight = 0;
  for (std::size_t i = 0; i < kMetrics; ++i) {
    sum += weights[i] * marks.metrics[i];
    weight += weights[i];
  }
  return sum / weight;
}

std::vector<Standing> rank(std::span<const NetworkMarks> schemes, const Weights& weights) {
  std::vector<Standing> standings;
  for (std::size_t i = 0; i < schemes.size(); ++i) {
    Standing standing{.scheme = i};
    for (const Marks& marks : schemes[i]) {
      standing.score += score_of(marks, weights) / static_cast<double>(schemes[i].size());
      const bool has_failed =
          std::find(marks.fails.begin(), marks.fails.end(), true) != marks.fails.end();
      standing.failed += has_failed ? 1 : 0;
    }
    standings.push_back(standing);
  }
  std::sort(standings.begin(), standings.end(), [](const Standing& a, const Standing& b) {
    return std::tie(a.failed, a.score, a.scheme) < std::tie(b.failed, b.score, b.scheme);
  });
  return standings;
}

std::size_t place_of(std::size_t scheme, std::span<const Standing> standings) {
  std::size_t place = 1;
  for (std::size_t i = 0; i < standings.size(); ++i) {
    const bool is_same = i > 0 && standings[i].failed == standings[i - 1].failed &&
                         standings[i].score - standings[place - 1].score < kSameScore;
    if (!is_same) place = i + 1;
    if (standings[i].scheme == scheme) break;
  }
  return place;
}

}  // namespace thimble::lab
