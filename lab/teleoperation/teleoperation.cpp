#include "lab/teleoperation/teleoperation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/spring_damper_arm.hpp"
#include "daemon/coupling/wave_arm.hpp"
#include "lab/trial/comfort_marks.hpp"
#include "lab/trial/finger.hpp"
#include "lab/trial/pair_loop.hpp"
#include "lab/trial/parameters.hpp"

namespace thimble::lab {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);
constexpr std::array kDelays_s{0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5};
constexpr double kLead_m = 0.03;
constexpr double kLead_m_per_s = 0.1;
constexpr double kPush_newton = 2;  // teleop.md 5, M5
constexpr double kVise_newton_per_m = 20'000;
constexpr double kStill_m = 0.0006;    // ours: the ghost point's hysteresis, and G1's half
constexpr double kGiven_joule = 1e-3;  // teleop.md 5, G2
constexpr double kCoordinateSpring_newton_per_m = 50;
constexpr double kLeastShare = 0.45;  // ours: decision 0446

enum class Peers { SpringDamper, Wave, Touch };
constexpr std::array kPeers{Peers::SpringDamper, Peers::Wave, Peers::Touch};

const char* name_of(Peers peers) {
  if (peers == Peers::SpringDamper) return "spring-damper";
  return peers == Peers::Wave ? "wave" : "ghost-point + spring-damper";
}

// TwoHosts: constant, too, but the second arm is on another host, behind our own datagrams.
enum class Network { Constant, Bad, TwoHosts };
constexpr std::array kNetworks{Network::Constant, Network::Bad, Network::TwoHosts};

const char* name_of(Network network) {
  if (network == Network::TwoHosts) return "two hosts";
  return network == Network::Bad ? "bad" : "constant";
}

struct Run {
  Peers peers{Peers::SpringDamper};
  double delay_s{0};  // to the other arm and back
  Network network{Network::Constant};
  std::uint64_t seed{1};
};

// NaN: does not apply.
struct Measured {
  Run run;
  double drag_newton{0};     // mean while it is led
  double behind_m{0};        // the second arm, at rest
  double felt_newton{0};     // at the first arm, in the vise
  double pressed_newton{0};  // by the second
  double stiffness_newton_per_m{0};
  double shifted_m{0};  // the frame of the first
  double swing_m{0};
  double given_joule{0};

  [[nodiscard]] bool is_still() const { return swing_m <= kStill_m; }
  // The ghost point's coordinate spring comes on top, at most half of the wall (decision 0055).
  [[nodiscard]] bool is_shared() const {
    const double most = run.peers == Peers::Touch ? 1.55 : 1.05;
    return felt_newton > 0.95 * pressed_newton && felt_newton < most * pressed_newton;
  }
  [[nodiscard]] bool is_passive() const {
    return given_joule <= kGiven_joule + kCoordinateSpring_newton_per_m * shifted_m * shifted_m / 2;
  }
};

std::unique_ptr<coupling::ArmCoupling> make_half(const Run& run, bool is_first) {
  const Peers peers = run.peers;
  if (peers == Peers::Wave) return std::make_unique<coupling::WaveArm>();
  if (peers == Peers::Touch && is_first) {
    return std::make_unique<coupling::GhostPointArm>(coupling::GhostPointSettings{});
  }
  coupling::SpringDamperSettings settings;
  if (run.network != Network::TwoHosts) {  // where it is told that there is an arm
    settings.force_at = coupling::ForceAt::Both;
    settings.is_between_arms = true;
  }
  return std::make_unique<coupling::SpringDamperArm>(settings);
}

// Each link has half of the way to the other arm and back; on two hosts there is one.
PairLoop::Arm arm_of(const Run& run, bool is_first) {
  const bool is_master = run.peers == Peers::Touch && is_first;
  const auto answer = is_master ? coupling::PeerAnswer::Touch : coupling::PeerAnswer::Motion;
  if (run.network == Network::TwoHosts) {
    if (is_first) return {make_half(run, true), answer, {}, {}};
    return {make_half(run, false),
            answer,
            {.delay_s = run.delay_s},
            DatagramLink::Settings{.seed = run.seed}};
  }
  link::ImpairmentSettings network{.delay_s = run.delay_s / 2,
                                   .seed = 2 * run.seed + (is_first ? 0 : 1)};
  if (run.network == Network::Bad) {
    network.jitter_s = network.delay_s / 2;
    network.loss = 0.05;
  }
  return {make_half(run, is_first), answer, network, {}};
}

// Both arms with the hands that hold them.
class Course {
 public:
  Course(const Run& run, const FingerSettings& second)
      : loop_(arm_of(run, true), arm_of(run, false), kTick),
        fingers_{Finger({}, kTick), Finger({}, kTick, second)} {}

  void tick(const FingerGoal& first) {
    out = loop_.tick({PairLoop::Seen{tip(0), fingers_[0].seen_velocity()},
                      PairLoop::Seen{tip(1), fingers_[1].seen_velocity()}});
    fingers_[0].move(first, out[0].force);
    fingers_[1].move({}, out[1].force);
  }
  void rest(double s, const FingerGoal& first = {}) {
    for (double t = 0; t < s; t += seconds(kTick)) tick(first);
  }
  [[nodiscard]] Position3 tip(std::size_t arm) const { return fingers_[arm].tip(); }
  [[nodiscard]] double given_joule(std::size_t arm) const {
    return fingers_[arm].energy().given_joule();
  }

  std::array<coupling::ArmOutput, 2> out{};

 private:
  PairLoop loop_;
  std::array<Finger, 2> fingers_;
};

// Waves between hands settle the slower, the longer the channel.
double settling_s(const Run& run) { return 6 + 80 * run.delay_s; }

void measure_free(Measured& into) {
  const FingerSettings nobody{.mass_kg = 0.1,
                              .stiffness_newton_per_m = 0,
                              .damping_newton_s_per_m = 0,
                              .friction_newton = 0.04};
  Course course(into.run, nobody);
  course.rest(0.3 + 2 * into.run.delay_s);
  FingerGoal goal;
  goal.moving.x = kLead_m_per_s;
  double sum_newton = 0;
  int ticks = 0;
  while (goal.at.x < kLead_m) {
    goal.at.x += kLead_m_per_s * seconds(kTick);
    course.tick(goal);
    sum_newton += norm(course.out[0].force);
    ++ticks;
  }
  goal.moving.x = 0;
  course.rest(settling_s(into.run), goal);
  into.drag_newton = sum_newton / ticks;
  into.behind_m = course.tip(0).x - course.tip(1).x;
}

void measure_vise(Measured& into) {
  const FingerSettings vise{.stiffness_newton_per_m = kVise_newton_per_m,
                            .damping_newton_s_per_m = 20};
  Course course(into.run, vise);
  course.rest(0.3 + 2 * into.run.delay_s);
  const FingerGoal push{.push_newton = kPush_newton, .is_pushing = true};
  course.rest(settling_s(into.run), push);
  double least_m = course.tip(0).x;
  double most_m = least_m;
  for (int i = 0; i < 2000; ++i) {
    course.tick(push);
    least_m = std::min(least_m, course.tip(0).x);
    most_m = std::max(most_m, course.tip(0).x);
    const double slave_joule = into.run.peers == Peers::Touch ? 0 : course.given_joule(1);
    into.given_joule = std::max(into.given_joule, course.given_joule(0) + slave_joule);
  }
  into.swing_m = most_m - least_m;
  into.felt_newton = -course.out[0].force.x;
  into.pressed_newton = course.out[1].force.x;
  into.shifted_m = norm(course.out[0].offset);
  const double deep_m = course.tip(0).x + course.out[0].offset.x - course.tip(1).x;
  into.stiffness_newton_per_m = into.pressed_newton / std::max(1e-9, deep_m);
}

Measured measure(const Run& run) {
  Measured out;
  out.run = run;
  measure_free(out);
  measure_vise(out);
  return out;
}

Table table_of(const std::vector<Measured>& all) {
  Table table{.name = "pairs",
              .title = "Two arms: one led through the open, then pushed against a vise",
              .columns = {{"schemes", ""},
                          {"network", ""},
                          {"delay", "ms", 0},
                          {"drag", "N", 2},
                          {"behind", "mm", 2},
                          {"felt", "N", 2},
                          {"pressed", "N", 2},
                          {"stiffness", "N/m", 0},
                          {"shifted", "mm", 1},
                          {"swing", "mm", 3},
                          {"given", "mJ", 2}},
              .rows = {}};
  for (const Measured& one : all) {
    table.rows.push_back({name_of(one.run.peers), name_of(one.run.network), 1e3 * one.run.delay_s,
                          one.drag_newton, 1e3 * one.behind_m, one.felt_newton, one.pressed_newton,
                          one.stiffness_newton_per_m, 1e3 * one.shifted_m, 1e3 * one.swing_m,
                          1e3 * one.given_joule});
  }
  return table;
}

Plot plot_of(const std::vector<Measured>& all, const std::string& name, const std::string& title,
             const std::string& y, double Measured::*number) {
  Plot plot{.name = name,
            .title = title,
            .x = {"delay to the other arm and back [ms]", true},
            .y = {y, false},
            .series = {}};
  for (const Peers peers : kPeers) {
    Series series{name_of(peers), Mark::LinePoints, {}};
    for (const Measured& one : all) {
      if (one.run.peers != peers || one.run.network != Network::Constant) continue;
      series.points.emplace_back(1e3 * one.run.delay_s, one.*number);
    }
    plot.series.push_back(series);
  }
  // Up to the highest mark.
  double most = 0;
  for (const Measured& one : all) most = std::max(most, one.*number);
  add_comfort_marks(plot, most);
  return plot;
}

// What a vise feels like there, beside one program: K_c is held for the whole of the one link.
double least_share_on_two_hosts(const std::vector<Measured>& all) {
  double least = 1;
  for (const Measured& one : all) {
    if (one.run.network != Network::TwoHosts) continue;
    for (const Measured& here : all) {
      const bool is_alike = here.run.network == Network::Constant &&
                            here.run.peers == one.run.peers && here.run.delay_s == one.run.delay_s;
      if (!is_alike) continue;
      least = std::min(least, one.stiffness_newton_per_m / here.stiffness_newton_per_m);
    }
  }
  return least;
}

std::vector<Criterion> criteria_of(const std::vector<Measured>& all) {
  const auto every = [&](const auto& holds) { return std::all_of(all.begin(), all.end(), holds); };
  return {{"held against the vise both arms are still within 0.6 mm, on each network",
           every([](const Measured& one) { return one.is_still(); })},
          {"what the first arm feels is what the second presses, within 5 %, but for the "
           "coordinate spring",
           every([](const Measured& one) { return one.is_shared(); })},
          {"the arms are given no more than 1 mJ, but for the coordinate spring",
           every([](const Measured& one) { return one.is_passive(); })},
          {"a ghost point feels nothing of an arm on its way", every([](const Measured& one) {
             return one.run.peers != Peers::Touch || one.drag_newton == 0;
           })},
          {"on two hosts a vise feels at least half as stiff as in one program, within 10 %",
           least_share_on_two_hosts(all) > kLeastShare}};
}

std::vector<Parameter> parameters_of(const TeleoperationSettings& settings) {
  std::vector<Parameter> all{{"seed", "", static_cast<double>(settings.seed)},
                             {"servo_rate", "Hz", 1000.0},
                             {"lead", "m", kLead_m},
                             {"lead_speed", "m/s", kLead_m_per_s},
                             {"push", "N", kPush_newton},
                             {"vise", "N/m", kVise_newton_per_m},
                             {"bad_jitter_of_delay", "", 0.5},
                             {"bad_loss", "", 0.05}};
  append(all, parameters_of(FingerSettings{}));
  const coupling::SchemeSettings between{
      .spring_damper = {.force_at = coupling::ForceAt::Both, .is_between_arms = true}};
  append(
      all,
      parameters_of(std::vector<CouplingCase>{
          {.name = "spring-damper", .scheme = coupling::Scheme::SpringDamper, .settings = between},
          {.name = "wave", .scheme = coupling::Scheme::Wave},
          {.name = "ghost-point", .scheme = coupling::Scheme::GhostPoint}}));
  return all;
}

}  // namespace

Result<Findings> run_teleoperation(const TeleoperationSettings& settings) {
  std::vector<Run> runs;
  for (const Network network : kNetworks) {
    for (const Peers peers : kPeers) {
      for (const double delay_s : kDelays_s) {
        runs.push_back({peers, delay_s, network, settings.seed});
      }
    }
  }
  const std::vector<Measured> all = run_all(
      runs.size(), [&](std::size_t i) { return measure(runs[i]); }, settings.progress);
  return Findings{.experiment = "teleoperation",
                  .title = "Two arms coupled to each other (thesis 5.3.5), 1 kHz",
                  .parameters = parameters_of(settings),
                  .tables = {table_of(all)},
                  .plots = {plot_of(all, "stiffness", "How stiff a vise at the other arm feels",
                                    "stiffness [N/m]", &Measured::stiffness_newton_per_m),
                            plot_of(all, "drag", "Drag of an arm that is led at 0.1 m/s",
                                    "drag [N]", &Measured::drag_newton)},
                  .criteria = criteria_of(all),
                  .remarks = {}};
}

}  // namespace thimble::lab
