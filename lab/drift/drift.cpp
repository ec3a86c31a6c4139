#include "lab/drift/drift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lab/drift/taps.hpp"
#include "lab/trial/parameters.hpp"

namespace thimble::lab {
namespace {

using link::SendMode;

constexpr std::array kDelays_s{0.020, 0.050, 0.100, 0.200};
constexpr std::array kRates_per_s{0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0};
constexpr double kShown_s = 0.100;
// Of table 4.1: from the wall to the end of the arm's reach.
constexpr double kReach_m = 0.0635 - 0.015;
// Ours: the last taps against the first, beyond what a phase of the servo makes.
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kLongRun = 80;
constexpr double kGrows_m = 0.002;
constexpr double kRateWithin = 0.02;
// Ours: theory counts no tick and no time in which the hand turns.
constexpr double kStreamedWithin = 0.10;
constexpr double kLockStepWithin = 0.20;
// SOURCE: teleop.md 2(e), "Drift", at 50, 100 and 200 ms.
constexpr std::array<std::pair<double, double>, 3> kFacts{
    {{0.050, 2.5}, {0.100, 1.2}, {0.200, 0.6}}};

std::vector<CouplingCase> cases() {
  using coupling::Scheme;
  CouplingCase recovery{.name = "constraint-plane, recovery", .scheme = Scheme::ConstraintPlane};
  recovery.settings.constraint_plane.late_walls = coupling::LateWalls::Recovery;
  return {
      {.name = "ghost-point", .scheme = Scheme::GhostPoint},
      {.name = "ghost-point, lock-step", .scheme = Scheme::GhostPoint, .mode = SendMode::LockStep},
      {.name = "constraint-plane, offset", .scheme = Scheme::ConstraintPlane},
      recovery,
      {.name = "composite", .scheme = Scheme::Composite}};
}

// By a wall of this world, which stays: walls that recover displace nothing, nor do those that are
// known before the hand is there.
bool is_displaced(const CouplingCase& of) {
  if (of.scheme == coupling::Scheme::GhostPoint) return true;
  return of.scheme == coupling::Scheme::ConstraintPlane &&
         of.settings.constraint_plane.late_walls == coupling::LateWalls::Offset;
}

// There and back, and what is late of either.
double least_apart_s(double delay_s) { return 2 * (delay_s + kTapFrom_m / kTapHand_m_per_s); }

struct Played {
  const CouplingCase* of{nullptr};
  double delay_s{0};
  double asked_per_s{0};
  Taps taps;

  [[nodiscard]] TapTheory theory() const { return tap_theory(delay_s, taps.taps_per_s, of->mode); }
  // Fewer a second where a tap takes longer than that; and theory counts each tap for itself, which
  // the next is not where the wall of the one before is still held when it comes.
  [[nodiscard]] bool is_of_theory() const {
    const bool is_as_asked = std::abs(taps.taps_per_s - asked_per_s) <= kRateWithin * asked_per_s;
    return is_as_asked && is_displaced(*of) && 1 / asked_per_s >= least_apart_s(delay_s);
  }
};

struct Critical {
  const CouplingCase* of{nullptr};
  double delay_s{0};
  double per_s{0};

  [[nodiscard]] double theory_per_s() const {
    return tap_theory(delay_s, 0, of->mode).critical_per_s;
  }
};

Result<bool> grows(const CouplingCase& of, double delay_s, double per_s) {
  const auto taps = run_taps({.of = of, .delay_s = delay_s, .taps_per_s = per_s, .taps = kLongRun});
  if (!taps) return tl::unexpected(taps.error());
  const auto& offsets = taps->offsets_m;
  if (offsets.size() < kLongRun) return true;
  const auto mean_of = [&](std::size_t from, std::size_t to) {
    double sum = 0;
    for (std::size_t i = from; i < to; ++i) sum += offsets[i];
    return sum / static_cast<double>(to - from);
  };
  return mean_of(3 * kLongRun / 4, kLongRun) > mean_of(0, kLongRun / 4) + kGrows_m;
}

Result<Critical> find_critical(const CouplingCase& of, double delay_s) {
  const double theory = tap_theory(delay_s, 0, of.mode).critical_per_s;
  double low = theory / 2;
  double high = theory * 2;
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    const auto found = grows(of, delay_s, middle);
    if (!found) return tl::unexpected(found.error());
    (*found ? high : low) = middle;
  }
  return Critical{.of = &of, .delay_s = delay_s, .per_s = std::sqrt(low * high)};
}

Table taps_table(const std::vector<Played>& all) {
  Table table{.name = "taps",
              .title = "Up to 40 taps at 0.2 m/s on a wall that is learned of late",
              .columns = {{"scheme", ""},
                          {"delay", "ms", 0},
                          {"asked", "1/s", 2},
                          {"done", "1/s", 2},
                          {"first", "mm", 2},
                          {"last", "mm", 2},
                          {"drift", "mm/s", 2},
                          {"theory", "mm/s", 2},
                          {"given_per_tap", "mJ", 2},
                          {"taps", "", 0}},
              .rows = {}};
  for (const Played& one : all) {
    const auto& offsets = one.taps.offsets_m;
    const double count = static_cast<double>(offsets.size());
    table.rows.push_back({one.of->name, 1e3 * one.delay_s, one.asked_per_s, one.taps.taps_per_s,
                          1e3 * offsets.front(), 1e3 * offsets.back(),
                          1e3 * drift_m_per_s(one.taps),
                          one.is_of_theory() ? 1e3 * one.theory().drift_m_per_s : kNone,
                          1e3 * one.taps.generated_joule / count, count});
  }
  return table;
}

Table critical_table(const std::vector<Critical>& all) {
  Table table{.name = "critical",
              .title = "Taps a second from which on the frame gets away",
              .columns = {{"scheme", ""},
                          {"delay", "ms", 0},
                          {"theory", "1/s", 2},
                          {"measured", "1/s", 2},
                          {"over_theory", "", 2}},
              .rows = {}};
  for (const Critical& one : all) {
    table.rows.push_back({one.of->name, 1e3 * one.delay_s, one.theory_per_s(), one.per_s,
                          one.per_s / one.theory_per_s()});
  }
  return table;
}

Plot taps_plot(const std::vector<Played>& all) {
  Plot plot{.name = "taps",
            .title = "Ghost point, streamed, 100 ms: offset when a tap is felt",
            .x = {"tap", false},
            .y = {"offset [mm]", false},
            .series = {}};
  int style = 0;
  for (const Played& one : all) {
    const bool is_shown = one.asked_per_s == 0.5 || one.asked_per_s == 1 ||
                          one.asked_per_s == 1.5 || one.asked_per_s == 2;
    if (one.of->name != "ghost-point" || one.delay_s != kShown_s || !is_shown) continue;
    ++style;
    char label[32];
    std::snprintf(label, sizeof label, "%.1f taps/s", one.asked_per_s);
    Series measured{label, Mark::Points, {}, style};
    Series theory{style == 1 ? "dashed: theory" : "", Mark::Dashed, {}, style};
    for (std::size_t i = 0; i < one.taps.offsets_m.size(); ++i) {
      const double expected_m = one.theory().gain_m + static_cast<double>(i) *
                                                          one.theory().drift_m_per_s /
                                                          one.taps.taps_per_s;
      measured.points.emplace_back(i + 1, 1e3 * one.taps.offsets_m[i]);
      theory.points.emplace_back(i + 1, 1e3 * expected_m);
    }
    plot.series.push_back(measured);
    plot.series.push_back(theory);
  }
  plot.series.push_back(
      {"end of the thesis's reach", Mark::Line, {{1, 1e3 * kReach_m}, {40, 1e3 * kReach_m}}, 7});
  return plot;
}

Plot drift_plot(const std::vector<Played>& all) {
  Plot plot{.name = "drift",
            .title = "Ghost point, streamed: how fast the frame gets away",
            .x = {"taps [1/s]", false},
            .y = {"drift [mm/s]", false},
            .series = {}};
  int style = 0;
  for (const double delay_s : kDelays_s) {
    ++style;
    Series measured{std::to_string(std::lround(1e3 * delay_s)) + " ms", Mark::Points, {}, style};
    Series theory{style == 1 ? "dashed: theory" : "", Mark::Dashed, {}, style};
    for (const Played& one : all) {
      if (one.of->name != "ghost-point" || one.delay_s != delay_s || !one.is_of_theory()) continue;
      measured.points.emplace_back(one.taps.taps_per_s, 1e3 * drift_m_per_s(one.taps));
    }
    for (double per_s = kRates_per_s.front(); per_s <= kRates_per_s.back(); per_s += 0.05) {
      if (per_s > measured.points.back().first + 0.05) break;
      theory.points.emplace_back(
          per_s, 1e3 * tap_theory(delay_s, per_s, SendMode::Streamed).drift_m_per_s);
    }
    plot.series.push_back(measured);
    plot.series.push_back(theory);
  }
  return plot;
}

Plot critical_plot(const std::vector<Critical>& all) {
  Plot plot{.name = "critical",
            .title = "Taps a second that the frame can follow, hand at 0.2 m/s",
            .x = {"round-trip delay [ms]", false},
            .y = {"taps [1/s]", true},
            .series = {}};
  int style = 0;
  for (const Critical& one : all) {
    if (plot.series.empty() || plot.series[plot.series.size() - 2].label != one.of->name) {
      ++style;
      plot.series.push_back({one.of->name, Mark::Points, {}, style});
      plot.series.push_back({style == 1 ? "dashed: theory" : "", Mark::Dashed, {}, style});
    }
    const std::size_t last = plot.series.size() - 1;
    plot.series[last - 1].points.emplace_back(1e3 * one.delay_s, one.per_s);
    plot.series[last].points.emplace_back(1e3 * one.delay_s, one.theory_per_s());
  }
  Series facts{"by arithmetic, from the thesis's 25 mm/s", Mark::Points, {}, 7};
  for (const auto& [delay_s, per_s] : kFacts) facts.points.emplace_back(1e3 * delay_s, per_s);
  plot.series.push_back(facts);
  return plot;
}

std::vector<Criterion> criteria_of(const std::vector<Played>& all,
                                   const std::vector<Critical>& critical) {
  const auto is_near = [](const Critical& one) {
    const bool is_streamed = one.of->mode == SendMode::Streamed;
    const double within = is_streamed ? kStreamedWithin : kLockStepWithin;
    return std::abs(one.per_s / one.theory_per_s() - 1) <= within;
  };
  const auto follows = [](const Played& one) {
    if (!one.is_of_theory() || one.of->mode == SendMode::LockStep) return true;
    const double expected = one.theory().drift_m_per_s;
    // A tenth of what the taps add.
    const double within = kStreamedWithin * one.taps.taps_per_s * one.theory().gain_m + 1e-4;
    return std::abs(drift_m_per_s(one.taps) - expected) <= within;
  };
  return {
      {"the frame gets away from r/(n*v*D - H + r*n*D) taps a second on, within 10 % (lock-step: "
       "20 %)",
       std::all_of(critical.begin(), critical.end(), is_near)},
      {"streamed: it gets away as fast as theory says, within a tenth of what taps add",
       std::all_of(all.begin(), all.end(), follows)},
      {"walls that recover, or are known beforehand, displace no frame",
       std::all_of(all.begin(), all.end(), [](const Played& one) {
         return is_displaced(*one.of) || one.taps.offsets_m.back() == 0;
       })}};
}

}  // namespace

Result<Findings> run_drift(const DriftSettings& settings) {
  const std::vector<CouplingCase> schemes = cases();
  const std::size_t at_each_delay = kRates_per_s.size();
  const auto runs = run_all(
      schemes.size() * kDelays_s.size() * at_each_delay,
      [&](std::size_t i) {
        return run_taps({.of = schemes[i / at_each_delay / kDelays_s.size()],
                         .delay_s = kDelays_s[i / at_each_delay % kDelays_s.size()],
                         .taps_per_s = kRates_per_s[i % at_each_delay]});
      },
      settings.progress);
  std::vector<Played> all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i]) return tl::unexpected(runs[i].error());
    all.push_back({&schemes[i / at_each_delay / kDelays_s.size()],
                   kDelays_s[i / at_each_delay % kDelays_s.size()], kRates_per_s[i % at_each_delay],
                   *runs[i]});
  }
  std::vector<Critical> critical;
  for (const CouplingCase& scheme : schemes) {
    for (const double delay_s : kDelays_s) {
      if (!is_displaced(scheme)) continue;
      const auto found = find_critical(scheme, delay_s);
      if (!found) return tl::unexpected(found.error());
      critical.push_back(*found);
    }
  }
  std::vector<Parameter> parameters{{"seed", "", static_cast<double>(settings.seed)},
                                    {"servo_rate", "Hz", 1000.0},
                                    {"hand_speed", "m/s", kTapHand_m_per_s},
                                    {"before_wall", "m", kTapFrom_m}};
  append(parameters, parameters_of(schemes));
  return Findings{.experiment = "drift",
                  .title = "Repeated taps on a wall that is learned of late (thesis 3.7), 1 kHz",
                  .parameters = std::move(parameters),
                  .tables = {taps_table(all), critical_table(critical)},
                  .plots = {taps_plot(all), drift_plot(all), critical_plot(critical)},
                  .criteria = criteria_of(all, critical),
                  .remarks = {}};
}

}  // namespace thimble::lab
