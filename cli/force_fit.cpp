#include "cli/force_fit.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace thimble::cli {
namespace {

constexpr double kNewtonPerGram = 9.80665e-3;  // standard gravity
constexpr double kMostGram = 20000;            // ours: no kitchen scale shows more
// Ours. A scale shows whole grams, and a hand that steadies the grip adds some.
constexpr double kWorstOfSpan = 0.1;

struct Line {
  double slope{0};
  double at_zero{0};
};

// Least squares of y = at_zero + slope * x; the x are not all alike.
Line fit_line(const std::vector<ScaleReading>& readings) {
  const auto count = static_cast<double>(readings.size());
  double mean_x = 0;
  double mean_y = 0;
  for (const ScaleReading& reading : readings) {
    mean_x += reading.pressed_newton / count;
    mean_y += reading.shown_gram * kNewtonPerGram / count;
  }
  double square = 0;
  double product = 0;
  for (const ScaleReading& reading : readings) {
    const double x = reading.pressed_newton - mean_x;
    square += x * x;
    product += x * (reading.shown_gram * kNewtonPerGram - mean_y);
  }
  const double slope = product / square;
  return {slope, mean_y - slope * mean_x};
}

std::size_t count_forces(const std::vector<ScaleReading>& readings) {
  std::vector<double> forces;
  forces.reserve(readings.size());
  for (const ScaleReading& reading : readings) forces.push_back(reading.pressed_newton);
  std::sort(forces.begin(), forces.end());
  return static_cast<std::size_t>(std::unique(forces.begin(), forces.end()) - forces.begin());
}

bool is_weaker(const ScaleReading& one, const ScaleReading& other) {
  return one.pressed_newton < other.pressed_newton;
}

tl::unexpected<Error> too_small(double span_gram) {
  std::array<char, 160> text{};
  std::snprintf(
      text.data(), text.size(),
      "the scale shows only %.0f g more at the strongest force, and below %.0f g no count "
      "can be told from the scale's own steps: press harder, with --most",
      span_gram, kLeastSpan_gram);
  return fail(Errc::InvalidArgument, text.data());
}

}  // namespace

double rise_gram(const std::vector<ScaleReading>& readings) {
  if (readings.empty()) return 0;
  const auto [weakest, strongest] =
      std::minmax_element(readings.begin(), readings.end(), is_weaker);
  return strongest->shown_gram - weakest->shown_gram;
}

std::vector<double> even_forces_newton(double most_newton, std::size_t count) {
  std::vector<double> steps;
  for (std::size_t i = 0; i < count; ++i) {
    steps.push_back(most_newton * static_cast<double>(i) / static_cast<double>(count - 1));
  }
  return steps;
}

Result<ForceScale> fit_force(const std::vector<ScaleReading>& readings,
                             double assumed_newton_per_count) {
  if (count_forces(readings) < 3) {
    return fail(Errc::InvalidArgument, "three different forces are needed at least");
  }
  const Line line = fit_line(readings);
  constexpr double kLeastSlope = 0.05;
  constexpr double kMostSlope = 5;
  if (!(line.slope >= kLeastSlope && line.slope <= kMostSlope)) {
    return fail(Errc::InvalidArgument,
                "the scale does not follow the force: does the grip rest on it, free of the hand?");
  }
  ForceScale scale;
  scale.newton_per_count = assumed_newton_per_count * line.slope;
  scale.rest_gram = line.at_zero / kNewtonPerGram;
  const auto [weakest, strongest] =
      std::minmax_element(readings.begin(), readings.end(), is_weaker);
  const double span_newton = line.slope * (strongest->pressed_newton - weakest->pressed_newton);
  for (const ScaleReading& reading : readings) {
    const double meant_newton = line.slope * reading.pressed_newton;
    const double off_newton =
        std::abs(reading.shown_gram * kNewtonPerGram - line.at_zero - meant_newton);
    scale.worst_off_newton = std::max(scale.worst_off_newton, off_newton);
  }
  if (!(scale.worst_off_newton <= kWorstOfSpan * span_newton)) {
    return fail(Errc::InvalidArgument,
                "the readings lie on no straight line: do not touch the grip, let the scale "
                "settle, and try again");
  }
  const double span_gram = span_newton / kNewtonPerGram;
  if (span_gram < kLeastSpan_gram) return too_small(span_gram);
  return scale;
}

Result<double> parse_gram(const std::string& typed) {
  std::string text = typed;
  std::replace(text.begin(), text.end(), ',', '.');
  const auto trim = [&text](char c) {
    while (!text.empty() && text.back() == c) text.pop_back();
  };
  trim('\r');
  trim(' ');
  trim('g');
  trim(' ');
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
  double gram = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, gram, std::chars_format::fixed);
  if (error == std::errc{} && stop == end && std::abs(gram) <= kMostGram) return gram;
  return fail(Errc::InvalidArgument, "type what the scale shows, in grams, such as 123");
}

}  // namespace thimble::cli
