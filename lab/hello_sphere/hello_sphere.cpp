#include "lab/hello_sphere/hello_sphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lab/hello_sphere/touch.hpp"
#include "lab/trial/declared_energy.hpp"
#include "lab/trial/finger.hpp"
#include "lab/trial/parameters.hpp"

namespace thimble::lab {
namespace {

using coupling::Scheme;

constexpr std::array kDelays_s{0.001, 0.002, 0.005, 0.010, 0.020, 0.050, 0.100, 0.200};
// SOURCE: teleop.md section 1, UDP "as high as 1 ms".
constexpr double kEthernet_s = 0.001;
// SOURCE: teleop.md section 5, G1. Ours: what nobody would call still.
constexpr double kStill_m = 0.0005;
constexpr double kSwings_m = 0.002;
constexpr double kSwingsFrom_s = 0.010;
constexpr double kShown_s = 0.020;  // in the plots over time and place
constexpr double kFloor_mm = 1e-3;
constexpr double kPi = 3.14159265358979323846;

std::vector<CouplingCase> cases() {
  return {{.name = "remote-force", .scheme = Scheme::RemoteForce},
          {.name = "spring-damper", .scheme = Scheme::SpringDamper},
          {.name = "wave", .scheme = Scheme::Wave},
          {.name = "ghost-point", .scheme = Scheme::GhostPoint},
          {.name = "ghost-point, lock-step",
           .scheme = Scheme::GhostPoint,
           .mode = link::SendMode::LockStep},
          {.name = "constraint-plane", .scheme = Scheme::ConstraintPlane}};
}

struct Played {
  const CouplingCase* of{nullptr};
  double delay_s{0};
  Touch press{};
  Touch stroke{};
  Held rest{};
  double most_offset_m{0};
  double astray_m{0};  // of the stroke, from that without delay

  [[nodiscard]] bool is_remote() const { return of->scheme == Scheme::RemoteForce; }
  // Ours: as of one that shifts its frame with no contact, which is less than it declares.
  [[nodiscard]] double declared() const { return declared_joule(*of, 0, most_offset_m); }
};

Result<Played> play(const CouplingCase& of, double delay_s) {
  auto press = touch_ball(of, Gesture::Press, delay_s);
  if (!press) return tl::unexpected(press.error());
  auto stroke = touch_ball(of, Gesture::Stroke, delay_s);
  if (!stroke) return tl::unexpected(stroke.error());
  Played played{
      .of = &of, .delay_s = delay_s, .press = *std::move(press), .stroke = *std::move(stroke)};
  played.rest = held(played.press);
  for (const TouchTick& tick : played.press.ticks) {
    played.most_offset_m =
        std::max(played.most_offset_m, norm(tick.offset.x, tick.offset.y, tick.offset.z));
  }
  return played;
}

Table table_of(const std::vector<Played>& all) {
  Table table{.name = "touches",
              .title = "A finger that presses 10 mm deep on the ball, and one that strokes over it",
              .columns = {{"scheme", ""},
                          {"delay", "ms", 0},
                          {"swing", "mm", 3},
                          {"frequency", "Hz", 0},
                          {"held", "N", 2},
                          {"most", "N", 2},
                          {"offset", "mm", 1},
                          {"generated", "mJ", 2},
                          {"declared", "mJ", 2},
                          {"stroke_astray", "mm", 2}},
              .rows = {}};
  for (const Played& one : all) {
    table.rows.push_back({one.of->name, 1e3 * one.delay_s, 1e3 * one.rest.swing_m,
                          one.rest.swing_hz, one.rest.mean_newton, one.rest.most_newton,
                          1e3 * one.rest.offset_m, 1e3 * one.press.generated_joule,
                          1e3 * one.declared(), 1e3 * one.astray_m});
  }
  return table;
}

std::vector<const Played*> at_shown_delay(const std::vector<Played>& all) {
  std::vector<const Played*> chosen;
  for (const Played& one : all) {
    if (one.delay_s == kShown_s) chosen.push_back(&one);
  }
  return chosen;
}

// The others lie on the ghost point's.
bool has_line_of_its_own(const CouplingCase& of) {
  return of.scheme != Scheme::ConstraintPlane && of.mode == link::SendMode::Streamed;
}

Plot swings_plot(const std::vector<Played>& all) {
  Plot plot{.name = "swings",
            .title = "A finger held 10 mm deep in the ball (thesis 3.2)",
            .x = {"round-trip delay [ms]", true},
            .y = {"swing, peak to peak, at least 0.001 [mm]", true},
            .series = {}};
  for (const Played& one : all) {
    if (plot.series.empty() || plot.series.back().label != one.of->name) {
      plot.series.push_back({one.of->name, Mark::LinePoints, {}});
    }
    // Rest has no place on a logarithmic axis.
    plot.series.back().points.emplace_back(1e3 * one.delay_s,
                                           std::max(1e3 * one.rest.swing_m, kFloor_mm));
  }
  plot.series.push_back(
      {"still: 0.5 mm", Mark::Dashed, {{1, 1e3 * kStill_m}, {200, 1e3 * kStill_m}}, 7});
  // A dashed line would lie on the frame.
  Series ethernet{"thesis: its Ethernet, 1 ms", Mark::Points, {}, 8};
  for (const double swing_mm : {0.01, 0.1, 1.0, 10.0}) {
    ethernet.points.emplace_back(1e3 * kEthernet_s, swing_mm);
  }
  plot.series.push_back(ethernet);
  return plot;
}

Plot forces_plot(const std::vector<Played>& all, const Touch& undelayed) {
  Plot plot{.name = "forces",
            .title = "The same finger at 20 ms: upward force",
            .x = {"time [s]", false},
            .y = {"force before the limiter [N]", false},
            .series = {}};
  const auto add = [&](const std::string& label, Mark mark, const Touch& touch, int style) {
    Series series{label, mark, {}, style};
    for (const TouchTick& tick : touch.ticks) {
      if (tick.now_s <= 1) series.points.emplace_back(tick.now_s, tick.force.y);
    }
    plot.series.push_back(series);
  };
  int style = 0;
  for (const Played* one : at_shown_delay(all)) {
    ++style;
    if (!has_line_of_its_own(*one->of)) continue;
    add(one->of->name, Mark::Line, one->press, style);
  }
  add("without delay", Mark::Dashed, undelayed, 7);
  return plot;
}

Plot paths_plot(const std::vector<Played>& all, const Touch& undelayed) {
  Plot plot{.name = "paths",
            .title = "A finger drawn over the ball from left to right, at 20 ms",
            .x = {"x [mm]", false},
            .y = {"y [mm]", false},
            .series = {{"ball", Mark::Line, {}, 8}}};
  for (int degree = 0; degree <= 180; degree += 3) {
    const double angle_rad = kPi * degree / 180;
    plot.series[0].points.emplace_back(-1e3 * kBall_m * std::cos(angle_rad),
                                       1e3 * (kBallCenter_m + kBall_m * std::sin(angle_rad)));
  }
  const auto add = [&](const std::string& label, Mark mark, const Touch& touch, int style) {
    Series series{label, mark, {}, style};
    for (const TouchTick& tick : touch.ticks) {
      series.points.emplace_back(1e3 * tick.tip.x, 1e3 * tick.tip.y);
    }
    plot.series.push_back(series);
  };
  int style = 0;
  for (const Played* one : at_shown_delay(all)) {
    ++style;
    if (!has_line_of_its_own(*one->of)) continue;
    add(one->of->name, Mark::Line, one->stroke, style);
  }
  add("without delay", Mark::Dashed, undelayed, 7);
  return plot;
}

bool all_of(const std::vector<Played>& all, const auto& holds) {
  return std::all_of(all.begin(), all.end(), holds);
}

std::vector<Criterion> criteria_of(const std::vector<Played>& all) {
  return {
      {"remote-force holds still at 1 ms, and swings by more than 2 mm from 10 ms on",
       all_of(all,
              [](const Played& one) {
                if (!one.is_remote()) return true;
                if (one.delay_s <= kEthernet_s) return one.rest.swing_m < kStill_m;
                return one.delay_s < kSwingsFrom_s || one.rest.swing_m > kSwings_m;
              })},
      {"all others hold still within 0.5 mm at any delay",
       all_of(all,
              [](const Played& one) { return one.is_remote() || one.rest.swing_m < kStill_m; })},
      {"and give the finger no more energy than 1 mJ and that of the displaced frame",
       all_of(all, [](const Played& one) {
         return one.is_remote() || one.press.generated_joule <= one.declared();
       })}};
}

}  // namespace

Result<Findings> run_hello_sphere(const HelloSphereSettings& settings) {
  const std::vector<CouplingCase> schemes = cases();
  const CouplingCase reference{.name = "without delay"};
  const auto undelayed = play(reference, 0);
  if (!undelayed) return tl::unexpected(undelayed.error());
  const auto runs = run_all(
      schemes.size() * kDelays_s.size(),
      [&](std::size_t i) {
        return play(schemes[i / kDelays_s.size()], kDelays_s[i % kDelays_s.size()]);
      },
      settings.progress);
  std::vector<Played> all;
  for (const auto& run : runs) {
    if (!run) return tl::unexpected(run.error());
    all.push_back(*run);
    all.back().astray_m = distance_m(run->stroke, undelayed->stroke);
  }
  std::vector<Parameter> parameters{{"seed", "", static_cast<double>(settings.seed)},
                                    {"servo_rate", "Hz", 1000.0},
                                    {"ball_radius", "m", kBall_m},
                                    {"held_undelayed", "N", undelayed->rest.mean_newton}};
  append(parameters, touch_parameters());
  append(parameters, parameters_of(FingerSettings{}));
  append(parameters, parameters_of(schemes));
  return Findings{
      .experiment = "hello-sphere",
      .title =
          "\"Hello, sphere\" (thesis 3.2) through each scheme: ball of 20 mm, finger of 0.15 kg",
      .parameters = std::move(parameters),
      .tables = {table_of(all)},
      .plots = {swings_plot(all), forces_plot(all, undelayed->press),
                paths_plot(all, undelayed->stroke)},
      .criteria = criteria_of(all),
      .remarks = {"buffer-zone and composite are not there: they are made of cells, and the ball "
                  "has none."}};
}

}  // namespace thimble::lab
