#include "lab/stability/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lab/stability/stability_cases.hpp"
#include "lab/stability/theory.hpp"
#include "lab/trial/parameters.hpp"

namespace thimble::lab {
namespace {

// SOURCE: teleop.md 2(a), and the longest of its section 4.
constexpr std::array kDelays_s{0.001, 0.002, 0.005, 0.010, 0.020, 0.050, 0.100, 0.200, 0.500};
constexpr double kPeriod_s = 1e-3;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// SOURCE: teleop.md 2(a), "Test", and section 1.
constexpr double kWithin = 0.15;
constexpr double kShort_s = 0.020;
constexpr double kThesisWall_newton_per_m = 800;
constexpr int kThesisStyle = 7;  // black
// Ours: a halving is good for 1 %, and the filtered velocity has no part in the formula.
constexpr double kWithinAnyDelay = 0.05;
constexpr double kSameAtAnyDelay = 0.03;

struct Limit {
  const StabilityCase* of{nullptr};
  double delay_s{0};
  Largest found;

  [[nodiscard]] double theory() const { return of->theory_newton_per_m(delay_s); }
  // Of the remote closed loop only, else NaN.
  [[nodiscard]] double any_delay() const {
    if (of->theory != Theory::RemoteForce) return kNone;
    return any_delay_limit(kHand_kg, of->damping_newton_s_per_m, delay_s, kPeriod_s).newton_per_m;
  }
  [[nodiscard]] bool is_near(double expected, double within) const {
    if (found.is_at_low) return false;
    if (found.is_at_high) return found.newton_per_m <= (1 + within) * expected;
    return std::abs(found.newton_per_m - expected) <= within * expected;
  }
};

std::vector<Limit> of_theory(const std::vector<Limit>& all, Theory theory) {
  std::vector<Limit> chosen;
  for (const Limit& one : all) {
    if (one.of->theory == theory) chosen.push_back(one);
  }
  return chosen;
}

bool all_of(const std::vector<Limit>& limits, const auto& holds) {
  return !limits.empty() && std::all_of(limits.begin(), limits.end(), holds);
}

Table table_of(const std::vector<Limit>& all) {
  Table table{.name = "limits",
              .title = "Largest stable stiffness, and that of theory",
              .columns = {{"scheme", ""},
                          {"hand_damping", "N.s/m", 0},
                          {"delay", "ms", 0},
                          {"theory", "N/m", 0},
                          {"any_delay", "N/m", 0},
                          {"measured", "N/m", 0},
                          {"over_theory", "", 2},
                          {"remark", ""}},
              .rows = {}};
  for (const Limit& one : all) {
    const char* remark = "";
    if (one.found.is_at_high) remark = "stable at the hardest there is";
    if (one.found.is_at_low) remark = "softer ones swing, too";
    table.rows.push_back({one.of->name, one.of->damping_newton_s_per_m, 1e3 * one.delay_s,
                          one.theory(), one.any_delay(), one.found.newton_per_m,
                          one.found.newton_per_m / one.theory(), remark});
  }
  return table;
}

Series series_of(const std::string& label, Mark mark, const std::vector<Limit>& of, int style,
                 const auto& value) {
  Series series{label, mark, {}, style};
  for (const Limit& one : of) series.points.emplace_back(1e3 * one.delay_s, value(one));
  return series;
}

double measured(const Limit& one) { return one.found.newton_per_m; }

Series thesis_wall() {
  return {"thesis, wall of 800 N/m",
          Mark::Line,
          {{1e3 * kDelays_s.front(), kThesisWall_newton_per_m},
           {1e3 * kDelays_s.back(), kThesisWall_newton_per_m}},
          kThesisStyle};
}

Plot plot_of(const char* name, const char* title) {
  return {.name = name,
          .title = title,
          .x = {"round-trip delay [ms]", true},
          .y = {"largest stable stiffness [N/m]", true},
          .series = {thesis_wall()}};
}

// All delays of one case.
std::vector<std::vector<Limit>> by_case(const std::vector<Limit>& all) {
  std::vector<std::vector<Limit>> cases;
  for (const Limit& one : all) {
    if (cases.empty() || cases.back().front().of != one.of) cases.emplace_back();
    cases.back().push_back(one);
  }
  return cases;
}

Plot remote_plot(const std::vector<Limit>& all) {
  Plot plot = plot_of("remote-force", "Remote closed loop (thesis 3.2): hand of 0.15 kg, 1 kHz");
  int style = 0;
  for (const auto& one : by_case(of_theory(all, Theory::RemoteForce))) {
    ++style;
    const std::string b =
        "b = " + std::to_string(std::lround(one.front().of->damping_newton_s_per_m)) + " N·s/m";
    plot.series.push_back(series_of(b + ", measured", Mark::Points, one, style, measured));
    plot.series.push_back(series_of(b + ", any delay", Mark::Line, one, style,
                                    [](const Limit& limit) { return limit.any_delay(); }));
    plot.series.push_back(series_of(style == 1 ? "dashed: b/(Ts/2 + D)" : "", Mark::Dashed, one,
                                    style, [](const Limit& limit) { return limit.theory(); }));
  }
  return plot;
}

// Whom the plot of all schemes shows: of those that lie on each other one.
struct Shown {
  const char* name;
  const char* label;
  bool has_theory;
};
constexpr std::array kShown{
    Shown{"ghost-point, as it ships", "ghost-point, as it ships", false},
    Shown{"ghost-point", "ghost-point, constraint-plane, buffer-zone, composite", true},
    Shown{"wave, b = 10", "wave, b = 2, 10, 40: no wall is harder", false},
    Shown{"spring-damper, both ends", "spring-damper, both ends", true},
    Shown{"spring-damper", "spring-damper, world's end", true},
    Shown{"remote-force", "remote-force", true}};

Plot schemes_plot(const std::vector<Limit>& all) {
  Plot plot =
      plot_of("schemes", "All schemes: hand of 0.15 kg and 2 N·s/m (spring-damper: 0), 1 kHz");
  int style = 0;
  const auto cases = by_case(all);
  for (const Shown& shown : kShown) {
    ++style;
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const auto& one) {
      return one.front().of->name == shown.name;
    });
    if (found == cases.end()) continue;
    plot.series.push_back(series_of(shown.label, Mark::LinePoints, *found, style, measured));
    if (!shown.has_theory) continue;
    plot.series.push_back(series_of(style == 2 ? "dashed: theory" : "", Mark::Dashed, *found, style,
                                    [](const Limit& limit) { return limit.theory(); }));
  }
  return plot;
}

bool is_the_same_at_any_delay(const std::vector<Limit>& all) {
  return all_of(all, [&](const Limit& one) {
    return std::all_of(all.begin(), all.end(), [&](const Limit& other) {
      return one.of != other.of || one.is_near(other.found.newton_per_m, kSameAtAnyDelay);
    });
  });
}

// Theory is sufficient only: no less, as far as the scheme can be made so stiff.
bool is_no_less(const Limit& one) {
  const double expected = std::min(one.theory(), one.of->ceiling_newton_per_m);
  return !one.found.is_at_low && one.found.newton_per_m >= (1 - kWithinAnyDelay) * expected;
}

std::vector<Criterion> criteria_of(const std::vector<Limit>& all) {
  const auto remote = of_theory(all, Theory::RemoteForce);
  const auto waves = of_theory(all, Theory::Passive);
  const auto here = of_theory(all, Theory::DeviceLimited);
  const auto expected = [](const Limit& one, double theory) {
    return std::min(theory, one.of->ceiling_newton_per_m);
  };
  return {{"remote-force: K = b/(Ts/2 + D) within 15 % up to 20 ms",
           all_of(remote,
                  [&](const Limit& one) {
                    return one.delay_s > kShort_s ||
                           one.is_near(expected(one, one.theory()), kWithin);
                  })},
          {"remote-force: the limit for any delay within 5 % up to 500 ms",
           all_of(remote,
                  [&](const Limit& one) {
                    return one.is_near(expected(one, one.any_delay()), kWithinAnyDelay);
                  })},
          {"spring-damper, force at the world's end: no less than 1.5*B/(D + Ts)",
           all_of(of_theory(all, Theory::WorldEnd), is_no_less)},
          {"spring-damper, force at both ends: no less than 2*B/(D + Ts)",
           all_of(of_theory(all, Theory::BothEnds), is_no_less)},
          {"wave: stable before the hardest wall there is, at any delay and impedance",
           all_of(waves, [](const Limit& one) { return one.found.is_at_high; })},
          {"walls that are rendered here: 2*b/Ts within 15 %",
           all_of(here, [](const Limit& one) { return one.is_near(one.theory(), kWithin); })},
          {"and the same at any delay within 3 %", is_the_same_at_any_delay(here)},
          {"the ghost point as it ships: no less than 2*b/Ts at any delay",
           all_of(of_theory(all, Theory::NoDelay), is_no_less)}};
}

// The stiffness that is sought is null.
std::vector<Parameter> parameters_of(const StabilitySettings& settings,
                                     const std::vector<StabilityCase>& cases) {
  std::vector<Parameter> all{{"seed", "", static_cast<double>(settings.seed)},
                             {"servo_rate", "Hz", 1 / kPeriod_s},
                             {"hand_mass", "kg", kHand_kg},
                             {"push", "N", Release{}.push_newton},
                             {"push_rendered_here", "N", kLean_newton}};
  append(all, release_parameters());
  std::vector<CouplingCase> schemes;
  for (const StabilityCase& of : cases) {
    const std::string hand = std::to_string(std::lround(of.damping_newton_s_per_m));
    CouplingCase scheme = of.with(kNone).of;
    scheme.name = of.name + ", hand of " + hand + " N.s/m";
    schemes.push_back(std::move(scheme));
  }
  append(all, parameters_of(schemes));
  return all;
}

}  // namespace

Result<Findings> run_stability(const StabilitySettings& settings) {
  const std::vector<StabilityCase> cases = stability_cases();
  const auto runs = run_all(
      cases.size() * kDelays_s.size(),
      [&](std::size_t i) {
        return cases[i / kDelays_s.size()].find_largest(kDelays_s[i % kDelays_s.size()]);
      },
      settings.progress);
  std::vector<Limit> all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i]) return tl::unexpected(runs[i].error());
    all.push_back({&cases[i / kDelays_s.size()], kDelays_s[i % kDelays_s.size()], *runs[i]});
  }
  return Findings{
      .experiment = "stability",
      .title = "Largest stable stiffness over delay: a hand that leans on a wall is kicked, 1 kHz",
      .parameters = parameters_of(settings, cases),
      .tables = {table_of(all)},
      .plots = {remote_plot(all), schemes_plot(all)},
      .criteria = criteria_of(all),
      .remarks = {}};
}

}  // namespace thimble::lab
