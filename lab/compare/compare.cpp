// lint: long-file one experiment: its grid, tables, plot and criteria
#include "lab/compare/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "lab/compare/bounded.hpp"
#include "lab/compare/compared.hpp"
#include "lab/compare/measures.hpp"
#include "lab/compare/ranking.hpp"
#include "lab/compare/ranking_tables.hpp"
#include "lab/compare/scenarios.hpp"
#include "lab/trial/comfort_marks.hpp"
#include "lab/trial/parameters.hpp"

namespace thimble::lab {
namespace {

// SOURCE: issue and teleop.md section 5.
constexpr std::array kDelays_s{0.001, 0.005, 0.010, 0.020, 0.050, 0.100, 0.200, 0.500};
constexpr double kJitter = 0.5;
constexpr double kLoss = 0.05;

enum class Network { Constant, Jitter, Loss, Outages };
constexpr std::array kNetworks{Network::Constant, Network::Jitter, Network::Loss, Network::Outages};

const char* name_of(Network network) {
  if (network == Network::Jitter) return "jitter 50 %";
  if (network == Network::Loss) return "loss 5 %";
  if (network == Network::Outages) return "outages 200 ms";
  return "constant";
}

StageSettings stage_of(const CompareSettings& settings, double delay_s, Network network) {
  StageSettings stage{.delay_s = delay_s, .moves = settings.moves, .seed = settings.seed};
  if (network == Network::Jitter) stage.jitter_s = kJitter * delay_s;
  if (network == Network::Loss) stage.loss = kLoss;
  stage.has_outages = network == Network::Outages;
  return stage;
}

// Runs in the order of delay, scheme, network.
class Grid {
 public:
  explicit Grid(const CompareSettings& settings) : settings_(settings) {
    for (CouplingCase& scheme : schemes_beside()) schemes_.push_back(std::move(scheme));
    for (CouplingCase& scheme : schemes_) {
      if (can_have(settings.guard, scheme)) scheme.guard = settings.guard;
    }
  }

  [[nodiscard]] std::size_t size() const {
    return kDelays_s.size() * schemes_.size() * kNetworks.size();
  }
  [[nodiscard]] std::size_t at(std::size_t delay, std::size_t scheme, std::size_t network) const {
    return (delay * schemes_.size() + scheme) * kNetworks.size() + network;
  }
  [[nodiscard]] Result<Measures> run(std::size_t i) const {
    const Network network = kNetworks[i % kNetworks.size()];
    const CouplingCase& scheme = scheme_of(i);
    const double delay_s = kDelays_s[i / kNetworks.size() / schemes_.size()];
    return measure(scheme, stage_of(settings_, delay_s, network));
  }
  [[nodiscard]] const std::vector<CouplingCase>& schemes() const { return schemes_; }
  // Those that criteria are of come first.
  [[nodiscard]] std::size_t judged() const { return judged_; }
  [[nodiscard]] bool is_judged(std::size_t run) const {
    return run / kNetworks.size() % schemes_.size() < judged_;
  }
  [[nodiscard]] const CouplingCase& scheme_of(std::size_t run) const {
    return schemes_[run / kNetworks.size() % schemes_.size()];
  }
  // How old what comes back is, there and back; a silence is there again and again.
  [[nodiscard]] double late_s_of(std::size_t run) const {
    const double delay_s = kDelays_s[run / kNetworks.size() / schemes_.size()];
    return has_outages(run) ? delay_s + kOutage_s : delay_s;
  }
  [[nodiscard]] bool has_outages(std::size_t run) const {
    return kNetworks[run % kNetworks.size()] == Network::Outages;
  }

 private:
  CompareSettings settings_;
  std::vector<CouplingCase> schemes_{compared_schemes()};
  std::size_t judged_{schemes_.size()};
};

struct Compared {
  Grid grid;
  Measures reference{};
  bool moves{false};
  std::vector<Measures> measures{};
  std::vector<Marks> marks{};

  [[nodiscard]] std::vector<NetworkMarks> marks_at(std::size_t delay,
                                                   Reading reading = Reading::Decided) const {
    std::vector<NetworkMarks> all;
    for (std::size_t scheme = 0; scheme < grid.schemes().size(); ++scheme) {
      NetworkMarks one;
      for (std::size_t network = 0; network < kNetworks.size(); ++network) {
        const Measures& found = measures[grid.at(delay, scheme, network)];
        one.push_back(marks_of(found, reference, moves, reading));
      }
      all.push_back(one);
    }
    return all;
  }
  // Of those that criteria are of.
  [[nodiscard]] std::vector<NetworkMarks> judged_at(std::size_t delay) const {
    std::vector<NetworkMarks> all = marks_at(delay);
    all.resize(grid.judged());
    return all;
  }
  [[nodiscard]] std::vector<DelayMarks> marks_by_delay() const {
    std::vector<DelayMarks> all;
    for (std::size_t delay = 0; delay < kDelays_s.size(); ++delay) {
      all.push_back({kDelays_s[delay], marks_at(delay)});
      for (const Reading reading : kReadingsBeside) {
        all.back().beside.push_back(marks_at(delay, reading));
      }
    }
    return all;
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const CouplingCase& scheme : grid.schemes()) all.push_back(scheme.name);
    return all;
  }
};

std::vector<Column> measure_columns(bool moves) {
  std::vector<Column> columns{
      {"delay", "ms", 0},      {"network", ""},         {"scheme", ""},
      {"onset", "ms", 0},      {"stiffness", "N/m", 0}, {"displacement", "mm", 1},
      {"drag", "N", 2},        {"mass", "kg", 2},       {"push_error", "N", 2},
      {"hold", "N", 2},        {"swing", "mm", 2},      {"residue", "N", 2},
      {"past_edge", "mm", 1},  {"missed_taps", "%", 0}, {"astray", "N", 2},
      {"astray_for", "ms", 0}, {"packets", "1/s", 0},   {"bytes", "kB/s", 0},
      {"generated", "mJ", 2},  {"declared", "mJ", 2},   {"most_force", "N", 2},
      {"most_rise", "N", 2},   {"most_jump", "N", 2},   {"most_pull", "N", 2}};
  if (moves) {
    columns.insert(columns.end(), {{"held_swing_before", "mm", 2},
                                   {"held_swing_last", "mm", 2},
                                   {"held_given", "mJ", 2},
                                   {"held_most_force", "N", 2},
                                   {"held_force_last", "N", 2}});
  }
  columns.push_back({"score", ""});
  return columns;
}

std::vector<Cell> measure_cells(const Measures& m) {
  return {1e3 * m.probed.onset_s,
          m.probed.stiffness_newton_per_m,
          1e3 * m.probed.displacement_m,
          m.drag_newton,
          m.mass_kg,
          m.push_error_newton,
          m.hold_newton,
          1e3 * m.swing_m,
          m.residue_newton,
          1e3 * m.edge_m,
          100 * m.missed_share,
          m.astray_newton,
          1e3 * m.astray_s,
          m.packets_per_s,
          1e-3 * m.bytes_per_s,
          1e3 * m.generated_joule,
          1e3 * m.declared_joule,
          m.most_newton,
          m.most_rise_newton,
          m.most_jump_newton,
          m.most_pull_newton};
}

std::vector<Cell> held_cells(const HeldAtWall& held) {
  return {1e3 * held.swing_before_m, 1e3 * held.swing_last_m, 1e3 * held.given_joule,
          held.most_newton, held.last_newton};
}

Table measures_table(const Compared& compared, bool moves) {
  Table table{.name = "measures",
              .title = "What was measured",
              .columns = measure_columns(moves),
              .rows = {}};
  for (std::size_t delay = 0; delay < kDelays_s.size(); ++delay) {
    for (std::size_t network = 0; network < kNetworks.size(); ++network) {
      for (std::size_t scheme = 0; scheme < compared.grid.schemes().size(); ++scheme) {
        const std::size_t i = compared.grid.at(delay, scheme, network);
        std::vector<Cell> row{1e3 * kDelays_s[delay], name_of(kNetworks[network]),
                              compared.grid.schemes()[scheme].name};
        for (Cell& cell : measure_cells(compared.measures[i])) row.push_back(std::move(cell));
        for (Cell& cell : held_cells(compared.measures[i].held)) {
          if (moves) row.push_back(std::move(cell));
        }
        row.emplace_back(score_of(compared.marks[i], kWeights));
        table.rows.push_back(std::move(row));
      }
    }
  }
  return table;
}

// Of a row beside: that of the scheme that it is another form of, else the next that is free.
int style_of(const Grid& grid, std::size_t scheme) {
  if (scheme < grid.judged()) return 0;
  for (std::size_t i = 0; i < grid.judged(); ++i) {
    const bool is_of = grid.schemes()[scheme].name.starts_with(grid.schemes()[i].name + ",");
    if (is_of) return static_cast<int>(i) + 1;
  }
  return static_cast<int>(grid.judged()) + 1;
}

Plot scores_plot(const Compared& compared) {
  Plot plot{.name = "scores",
            .title = "Score over delay, mean over four networks; lower is better",
            .x = {"round-trip delay [ms]", true},
            .y = {"score [1]", false},
            .series = {}};
  for (std::size_t scheme = 0; scheme < compared.grid.schemes().size(); ++scheme) {
    const bool is_beside = scheme >= compared.grid.judged();
    Series series{compared.grid.schemes()[scheme].name,
                  is_beside ? Mark::Points : Mark::LinePoints,
                  {},
                  style_of(compared.grid, scheme)};
    for (std::size_t delay = 0; delay < kDelays_s.size(); ++delay) {
      for (const Standing& standing : rank(compared.marks_at(delay), kWeights)) {
        if (standing.scheme != scheme) continue;
        series.points.emplace_back(1e3 * kDelays_s[delay], standing.score);
      }
    }
    plot.series.push_back(series);
  }
  add_comfort_marks(plot, 2);
  return plot;
}

std::size_t index_of(const Compared& compared, std::string_view name) {
  const auto& schemes = compared.grid.schemes();
  const auto found =
      std::find_if(schemes.begin(), schemes.end(), [&](const auto& s) { return s.name == name; });
  return static_cast<std::size_t>(found - schemes.begin());
}

// Nothing is unbounded but what theory says is (may_give() of bounded.hpp). What gives the hand no
// energy cannot grow, though a wave takes its time to come to rest (G1). A wall that moves works on
// the hand of whoever shifts no frame: see held_criterion().
Criterion bounded_criterion(const Compared& compared) {
  Criterion criterion{
      "only remote-force gives the hand energy, or asks for more than 8.5 N, and spring-damper "
      "after a silence of the network",
      true};
  for (std::size_t i = 0; i < compared.measures.size(); ++i) {
    if (!compared.grid.is_judged(i)) continue;
    if (may_give(compared.grid.scheme_of(i).scheme, compared.grid.has_outages(i))) continue;
    const bool is_hard = !may_ask_for_more(compared.grid.scheme_of(i).scheme) &&
                         !(compared.measures[i].most_newton <= kMost_newton);
    if (compared.marks[i].fails[static_cast<std::size_t>(Gate::Passive)] || is_hard) {
      criterion.is_met = false;
    }
  }
  return criterion;
}

// The same where the wall moves, of a hand that is held.
Criterion held_criterion(const Compared& compared) {
  Criterion criterion{
      "before the wall that moves a held hand swings no more in the end than before, is given no "
      "more than the wall puts in, and no more than 8.5 N is asked for, but by remote-force where "
      "its force is later than theory allows",
      true};
  for (std::size_t i = 0; i < compared.measures.size(); ++i) {
    if (!compared.grid.is_judged(i)) continue;
    if (may_grow(compared.grid.scheme_of(i).scheme, compared.grid.late_s_of(i))) continue;
    if (!is_bounded(compared.measures[i].held)) criterion.is_met = false;
  }
  return criterion;
}

Criterion first_criterion(const Compared& compared) {
  Criterion criterion{"composite is first from 20 ms up, alone or beside its equal", true};
  for (std::size_t delay = 0; delay < kDelays_s.size(); ++delay) {
    if (kDelays_s[delay] < 0.020) continue;
    const auto standings = rank(compared.judged_at(delay), kWeights);
    if (place_of(index_of(compared, "composite"), standings) != 1) criterion.is_met = false;
  }
  return criterion;
}

Criterion stiffness_criterion(const Compared& compared) {
  Criterion criterion{"composite feels the wall's whole stiffness at 500 ms, within 1 %", true};
  const std::size_t scheme = index_of(compared, "composite");
  const double wall = coupling::GhostPointSettings{}.stiffness.newton_per_m;
  for (std::size_t network = 0; network < kNetworks.size(); ++network) {
    const std::size_t i = compared.grid.at(kDelays_s.size() - 1, scheme, network);
    const double felt = compared.measures[i].probed.stiffness_newton_per_m;
    if (!(std::abs(felt / wall - 1) < 0.01)) criterion.is_met = false;
  }
  return criterion;
}

Criterion no_worse_criterion(const Compared& compared) {
  Criterion criterion{"composite fails no gate and is nowhere worse than ghost-point", true};
  for (std::size_t delay = 0; delay < kDelays_s.size(); ++delay) {
    const auto marks = compared.judged_at(delay);
    const auto standings = rank(marks, kWeights);
    const std::size_t ours = index_of(compared, "composite");
    const std::size_t ghost = index_of(compared, "ghost-point");
    const bool is_worse = place_of(ours, standings) > place_of(ghost, standings);
    if (is_worse || failed_gates(marks[ours]) != "-") criterion.is_met = false;
  }
  return criterion;
}

std::vector<Criterion> criteria_of(const Compared& compared, bool moves) {
  if (moves) return {held_criterion(compared), no_worse_criterion(compared)};
  return {bounded_criterion(compared), first_criterion(compared), stiffness_criterion(compared)};
}

std::vector<Parameter> parameters_of(const CompareSettings& settings, const Compared& compared) {
  std::vector<Parameter> all{{"seed", "", static_cast<double>(settings.seed)},
                             {"servo_rate", "Hz", 1000.0},
                             {"jitter_of_delay", "", kJitter},
                             {"loss", "", kLoss},
                             {"outage", "s", kOutage_s},
                             {"outage_every", "s", kOutageEvery_s},
                             {"cell", "m", kStageCell_m},
                             {"wall", "m", kWall_m},
                             {"hold_undelayed", "N", compared.reference.hold_newton}};
  if (settings.moves) all.push_back({"wall_moves_every", "s", kMoveEvery_s});
  for (std::size_t metric = 0; metric < kMetrics; ++metric) {
    const std::string_view name = to_string(static_cast<Metric>(metric));
    all.push_back({"weight: " + std::string(name), "", kWeights[metric]});
  }
  list_gates(all);
  list_probe(all);
  list_approach(all);
  list_presses(all);
  list_motions(all);
  if (settings.moves) list_hold(all);
  append(all, parameters_of(FingerSettings{}));
  append(all, parameters_of(compared.grid.schemes()));
  return all;
}

std::string remark_of(const Compared& compared) {
  std::string names;
  for (std::size_t i = compared.grid.judged(); i < compared.grid.schemes().size(); ++i) {
    names += (names.empty() ? "" : "; ") + compared.grid.schemes()[i].name;
  }
  return "No criterion is of: " + names + ".";
}

std::string name_of(const CompareSettings& settings) {
  const std::string name = std::string("compare") + (settings.moves ? "-moving" : "");
  if (settings.guard == Guard::AtHand) return name + "-guarded";
  return settings.guard == Guard::BothEnds ? name + "-two-port" : name;
}

std::string words_of(Guard guard) {
  if (guard == Guard::AtHand) return ", each with a passivity guard,";
  return guard == Guard::BothEnds ? ", guarded at both ends where the world tells a force," : "";
}

std::string title_of(const CompareSettings& settings) {
  return "Coupling schemes" + words_of(settings.guard) +
         (settings.moves ? " at a wall whose front moves by 3 mm every 0.7 s"
                         : " at a wall that stays");
}

}  // namespace

Result<Findings> run_compare(const CompareSettings& settings) {
  Compared compared{.grid = Grid(settings), .moves = settings.moves};
  const auto reference = measure(reference_scheme(), {.moves = settings.moves});
  if (!reference) return tl::unexpected(reference.error());
  compared.reference = *reference;
  const auto runs = run_all(
      compared.grid.size(), [&](std::size_t i) { return compared.grid.run(i); }, settings.progress);
  for (const auto& run : runs) {
    if (!run) return tl::unexpected(run.error());
    compared.measures.push_back(*run);
    compared.marks.push_back(marks_of(*run, compared.reference, settings.moves));
  }
  const auto names = compared.names();
  const auto marks = compared.marks_by_delay();
  std::vector<std::string> readings;
  readings.reserve(kReadingsBeside.size());
  for (const Reading reading : kReadingsBeside) readings.emplace_back(to_string(reading));
  return Findings{.experiment = name_of(settings),
                  .title = title_of(settings),
                  .parameters = parameters_of(settings, compared),
                  .tables = {measures_table(compared, settings.moves), left_out_table(names, marks),
                             ranking_table(names, marks, readings)},
                  .plots = {scores_plot(compared)},
                  .criteria = criteria_of(compared, settings.moves),
                  .remarks = {remark_of(compared)}};
}

}  // namespace thimble::lab
