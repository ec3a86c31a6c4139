#include "tests/campaign/programme.hpp"

#include <algorithm>
#include <cstdio>

#include "sim/model/falcon/falcon_parameters.hpp"
#include "tests/campaign/dice.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::array<std::string_view, kEventKindCount> kNames{
    "drop-in",      "drop-out",     "delay-in",     "delay-out",    "corrupt-in",  "corrupt-out",
    "truncate-in",  "truncate-out", "stall",        "disconnect",   "refuse-open", "lose-events",
    "delay-events", "unplug",       "estop",        "deadman-open", "withdraw",    "clear",
    "clear-other",  "late-servo",   "network-down", "shove",        "fill-cell",   "edit-fill",
    "edit-clear",   "edit-box",     "edit-paint",   "edit-all",     "halt",        "babble"};

// How long an event of each kind lasts: about as long as its limits of DESIGN section 4 and
// longer, so that both sides of each are met.
struct Spread {
  double shortest_s;
  double longest_s;
};
constexpr std::array<Spread, kEventKindCount> kSpreads{{
    {0.001, 0.03},   // drop-in
    {0.001, 0.6},    // drop-out: beyond the watchdog of the arm
    {0.001, 0.05},   // delay-in
    {0.001, 0.05},   // delay-out: the hundred milliseconds of zero outlast it
    {0.001, 0.004},  // corrupt-in
    {0.001, 0.004},  // corrupt-out
    {0.001, 0.01},   // truncate-in
    {0.001, 0.6},    // truncate-out: beyond the watchdog of the arm
    {0.001, 0.04},   // stall
    {0.002, 0.3},    // disconnect
    {0.01, 1.0},     // refuse-open
    {0.01, 1.0},     // lose-events
    {0.01, 1.0},     // delay-events
    {0.002, 1.5},    // unplug
    {0.001, 0.5},    // estop
    {0.001, 0.4},    // deadman-open
    {0.001, 0.4},    // withdraw
    {0, 0},          // clear
    {0, 0},          // clear-other
    {0.0005, 0.03},  // late-servo
    {0.005, 0.6},    // network-down
    {0.005, 0.3},    // shove
    {0.05, 2.0},     // fill-cell
    {0.05, 2.0},     // edit-fill
    {0.05, 2.0},     // edit-clear
    {0.05, 2.0},     // edit-box
    {0.05, 2.0},     // edit-paint
    {0.01, 0.5},     // edit-all
    {0.001, 0.03},   // halt
    {0.001, 0.03},   // babble
}};

// Long ones are rarer: the square of the chance.
Duration length_of(EventKind kind, Dice& dice) {
  const Spread spread = kSpreads[static_cast<std::size_t>(kind)];
  const double share = dice.uniform(0, 1);
  const double s = spread.shortest_s + (spread.longest_s - spread.shortest_s) * share * share;
  return from_seconds(s) / microseconds(100) * microseconds(100);
}

Force3 some_push(Dice& dice) {
  const double newton = dice.chance(0.1) ? 40 : 8;
  return {dice.uniform(-newton, newton), dice.uniform(-newton, newton),
          dice.uniform(-newton, newton)};
}

Event some_event(EventKind kind, Duration at, Dice& dice) {
  Event event{kind, at, length_of(kind, dice)};
  if (kind == EventKind::FillCell || is_edit(kind)) event.cell = dice.bits();
  if (kind == EventKind::Shove) event.push = some_push(dice);
  return event;
}

// A person clears what has latched every now and then; else most of an episode is silence.
void add_clears(Duration end, Dice& dice, std::vector<Event>& events) {
  Duration at{};
  while (true) {
    at += milliseconds(dice.chance(0.7) ? 50 + dice.below(300) : 300 + dice.below(1500));
    if (at >= end) return;
    events.push_back(some_event(EventKind::Clear, at, dice));
  }
}

void add_events(Duration end, double per_s, bool is_edited, Dice& dice,
                std::vector<Event>& events) {
  const auto kinds =
      static_cast<std::size_t>(is_edited ? EventKind::EditAll : EventKind::FillCell) + 1;
  // In the first two seconds the person calibrates and the force ramps up: mostly left alone.
  Duration at = dice.chance(0.8) ? milliseconds(1800) : Duration{};
  while (true) {
    at += microseconds(100) *
          static_cast<std::int64_t>(1 + dice.below(static_cast<std::uint64_t>(20'000 / per_s)));
    if (at >= end) return;
    const auto kind = static_cast<EventKind>(dice.below(kinds));
    events.push_back(some_event(kind, at, dice));
    // Troubles do not come alone.
    if (!dice.chance(0.2)) continue;
    const auto other = static_cast<EventKind>(dice.below(kinds));
    events.push_back(some_event(other, at + milliseconds(dice.below(30)), dice));
  }
}

sim::RandomFaults some_noise(Dice& dice) {
  sim::RandomFaults noise;
  if (dice.chance(0.5)) return noise;
  const double level = dice.chance(0.3) ? 0.02 : 0.002;
  for (double* chance :
       {&noise.drop_in, &noise.drop_out, &noise.delay_in, &noise.delay_out, &noise.corrupt_in,
        &noise.corrupt_out, &noise.truncate_in, &noise.truncate_out}) {
    if (dice.chance(0.3)) *chance = dice.uniform(0, level);
  }
  noise.max_delay = microseconds(100 + dice.below(10'000));
  if (dice.chance(0.3)) noise.stall = dice.uniform(0, 0.001);
  noise.stall_lasts = microseconds(500 + dice.below(15'000));
  return noise;
}

void draw_link(Dice& dice, Setup& setup) {
  setup.is_lock_step = dice.chance(0.3);
  if (dice.chance(0.6))
    setup.delay_s = dice.chance(0.8) ? dice.uniform(0, 0.1) : dice.uniform(0, 0.5);
  if (dice.chance(0.3)) setup.jitter_s = dice.uniform(0, setup.delay_s);
  if (dice.chance(0.3)) setup.loss = dice.uniform(0, 0.1);
  if (dice.chance(0.2)) setup.duplicate = dice.uniform(0, 0.1);
  if (dice.chance(0.2)) setup.reorder = dice.uniform(0, 0.1);
}

// On another bus, with another way to home and no watchdog that anybody knows of.
void draw_falcon(Dice dice, Setup& setup) {
  if (!dice.chance(1.0 / 12)) return;
  setup.device = "sim:falcon-loaded";
  if (dice.chance(0.8)) setup.newton_per_count = sim::FalconParameters{}.newton_per_count;
  const double level = dice.chance(0.3) ? 0.02 : 0.002;
  for (double* chance : {&setup.noise.halt, &setup.noise.babble}) {
    if (dice.chance(0.3)) *chance = dice.uniform(0, level);
  }
}

void add_usb_events(Duration end, Dice dice, std::vector<Event>& events) {
  Duration at{};
  while (true) {
    at += milliseconds(500 + dice.below(4000));
    if (at >= end) return;
    const auto kind = dice.chance(0.5) ? EventKind::Halt : EventKind::Babble;
    events.push_back(some_event(kind, at, dice));
  }
}

// Left alone for long enough that even one that must be loaded again has to be heard.
void calm_down(Duration end, Programme& programme) {
  constexpr Duration kCalm = std::chrono::seconds(15);
  programme.setup.noise = {};
  std::erase_if(programme.events, [&](const Event& event) {
    return event.at + event.lasts > end - kCalm && event.kind != EventKind::Clear;
  });
}

// A world without cells knows neither the simple model nor the scheme of the thesis.
void draw_world(Dice& dice, Setup& setup) {
  if (dice.chance(0.1)) {
    setup.world = "sphere";
    setup.is_simple_model = setup.is_thesis_literal = false;
  } else if (dice.chance(0.15)) {
    setup.world = "volume";
    setup.world_seed = dice.below(1'000'000);
    // The simple model tells no surface, and the printed callback feels none.
    if (!setup.is_simple_model) setup.materials = static_cast<int>(dice.below(4));
    if (setup.is_thesis_literal) setup.materials = 0;
  }
  setup.is_edited = dice.chance(0.35);
  setup.is_hostile = dice.chance(0.1);
  setup.has_bystander = dice.chance(0.08);
}

Setup some_setup(Dice& dice) {
  constexpr std::array kOtherRates{500, 2000, 4000, 8000};
  constexpr std::array<std::string_view, 8> kMotions{"explore", "explore", "explore", "poke",
                                                     "sweep",   "circle",  "tremor",  "still"};
  constexpr std::array<std::string_view, 4> kOtherArms{"sim:woody-2015", "sim:premium-1.5",
                                                       "sim:aluhaptics-2", "sim:polhem-1"};
  constexpr std::array kCells{3, 3, 5, 8, 64};
  Setup setup;
  if (dice.chance(0.25)) setup.rate_hz = kOtherRates[dice.below(kOtherRates.size())];
  if (dice.chance(0.4)) setup.device = kOtherArms[dice.below(kOtherArms.size())];
  setup.motion = kMotions[dice.below(kMotions.size())];
  setup.hand_seed = dice.below(1'000'000);
  setup.hand_speed_m_per_s = dice.uniform(0.05, 0.25);
  setup.hand_reach_m = dice.uniform(0.015, 0.03);
  setup.hand_newton_per_m = dice.uniform(100, 800);
  setup.cells = kCells[dice.below(kCells.size())];
  setup.is_simple_model = dice.chance(0.15);
  setup.is_thesis_literal = dice.chance(0.15);
  setup.stiffness_newton_per_m = dice.chance(0.1) ? 3000 : dice.uniform(200, 800);
  if (dice.chance(0.3)) setup.force_newton = dice.uniform(0.5, 5);
  if (dice.chance(0.2)) setup.rise_newton_per_s = dice.uniform(50, 1000);
  setup.amplifier_a = dice.chance(0.2) ? dice.uniform(0.5, 6) : 3;
  if (dice.chance(0.2)) setup.ramp_s = dice.uniform(0.5, 1.5);
  setup.is_realtime_required = dice.chance(0.1);
  draw_world(dice, setup);
  draw_link(dice, setup);
  setup.noise = some_noise(dice);
  return setup;
}

// So slow that a force which jumps to an arm's peak is more than what is granted in 30 ms.
void draw_slow_rise(Dice dice, Setup& setup) {
  if (dice.chance(0.15)) setup.rise_newton_per_s = dice.uniform(20, 120);
}

std::string line_of(const Event& event) {
  std::array<char, 160> line{};
  int size = std::snprintf(line.data(), line.size(), "  %9.4f s  %-13s", seconds(event.at),
                           std::string(to_string(event.kind)).c_str());
  const auto room = [&] { return line.size() - static_cast<std::size_t>(size); };
  char* const end = line.data();
  if (event.lasts > Duration{}) {
    size += std::snprintf(end + size, room(), " for %.1f ms", 1e3 * seconds(event.lasts));
  }
  if (event.kind == EventKind::Shove) {
    std::snprintf(end + size, room(), ", %.17g %.17g %.17g N", event.push.x, event.push.y,
                  event.push.z);
  }
  if (event.kind == EventKind::FillCell || is_edit(event.kind)) {
    std::snprintf(end + size, room(), ", number %llu", static_cast<unsigned long long>(event.cell));
  }
  return std::string(line.data()) + '\n';
}

}  // namespace

std::string_view to_string(EventKind kind) noexcept {
  return kNames[static_cast<std::size_t>(kind)];
}

std::optional<sim::FaultKind> fault_of(EventKind kind) noexcept {
  if (kind == EventKind::Halt) return sim::FaultKind::Halt;
  if (kind == EventKind::Babble) return sim::FaultKind::Babble;
  if (static_cast<std::size_t>(kind) >= sim::kHidFaultKindCount) return std::nullopt;
  return static_cast<sim::FaultKind>(kind);
}

std::vector<std::string> overrides(const Setup& setup) {
  std::vector<std::string> all;
  const auto set = [&all](const char* key, const auto& value) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>) {
      all.push_back(std::string(key) + '=' + std::to_string(value));
    } else {
      all.push_back(std::string(key) + '=' + std::string(value));
    }
  };
  set("arm.right.device", setup.device);
  set("servo.rate_hz", setup.rate_hz);
  set("arm.right.hand.motion", setup.motion);
  set("arm.right.hand.seed", setup.hand_seed);
  set("arm.right.hand.speed_m_per_s", setup.hand_speed_m_per_s);
  set("arm.right.hand.reach_m", setup.hand_reach_m);
  set("arm.right.hand.stiffness_newton_per_m", setup.hand_newton_per_m);
  if (setup.world == "box") set("world.source", "box:" + std::to_string(setup.cells));
  if (setup.world == "sphere") set("world.source", "sphere");
  if (setup.is_simple_model) set("world.constraint_model", "simple");
  if (setup.is_thesis_literal) set("arm.right.coupling.scheme", "thesis-literal");
  if (!setup.is_thesis_literal) {
    set("arm.right.coupling.stiffness_newton_per_m", setup.stiffness_newton_per_m);
  }
  if (setup.is_lock_step) set("arm.right.coupling.mode", "lock-step");
  if (setup.force_newton > 0) set("arm.right.limits.force_newton", setup.force_newton);
  set("arm.right.limits.rise_newton_per_s", setup.rise_newton_per_s);
  set("arm.right.limits.ramp_s", setup.ramp_s);
  set("arm.right.amplifier_max_a", setup.amplifier_a);
  if (setup.newton_per_count > 0) set("arm.right.newton_per_count", setup.newton_per_count);
  if (setup.is_realtime_required) set("servo.realtime", "required");
  set("arm.right.impairment.delay_s", setup.delay_s);
  set("arm.right.impairment.jitter_s", setup.jitter_s);
  set("arm.right.impairment.loss", setup.loss);
  set("arm.right.impairment.duplicate", setup.duplicate);
  set("arm.right.impairment.reorder", setup.reorder);
  set("arm.right.impairment.seed", setup.hand_seed + 1);
  return all;
}

Programme draw(std::uint64_t seed, std::uint64_t episode) {
  Programme programme;
  programme.seed = derive(seed, episode);
  Dice dice(programme.seed);
  programme.setup = some_setup(dice);
  draw_slow_rise(Dice(derive(programme.seed, 2)), programme.setup);
  draw_falcon(Dice(derive(programme.seed, 3)), programme.setup);
  // Calibration takes 1.2 s of any; what a faster servo adds are ticks, not events.
  const auto rate_hz = static_cast<std::uint64_t>(programme.setup.rate_hz);
  programme.ticks = rate_hz * (rate_hz <= 1000 ? 10 + dice.below(31) : 5 + dice.below(6));
  constexpr std::array kEvents_per_s{0.2, 1.0, 1.0, 5.0};
  const double per_s = kEvents_per_s[dice.below(kEvents_per_s.size())];
  const Duration end = from_seconds(static_cast<double>(programme.ticks) / programme.setup.rate_hz);
  add_events(end, per_s, programme.setup.is_edited, dice, programme.events);
  add_clears(end, dice, programme.events);
  if (programme.setup.is_bare_usb()) {
    add_usb_events(end, Dice(derive(programme.seed, 4)), programme.events);
    if (Dice(derive(programme.seed, 5)).chance(0.4)) calm_down(end, programme);
  }
  // Servos of one process wake late together: that would be something done to the bystander.
  if (programme.setup.has_bystander) {
    std::erase_if(programme.events,
                  [](const Event& event) { return event.kind == EventKind::LateServo; });
  }
  std::stable_sort(programme.events.begin(), programme.events.end(),
                   [](const Event& a, const Event& b) { return a.at < b.at; });
  return programme;
}

std::string to_text(const Programme& programme) {
  std::string text = std::to_string(programme.ticks) + " ticks of\n";
  for (const std::string& line : overrides(programme.setup)) text += "  --set " + line + '\n';
  const Setup& setup = programme.setup;
  if (setup.world == "volume") {
    text += "  in a volume of " + std::to_string(setup.cells) + " cells, seed " +
            std::to_string(setup.world_seed) + ", " + std::to_string(setup.materials) +
            " materials\n";
  }
  if (setup.is_hostile) text += "  whose world lies\n";
  if (setup.has_bystander) text += "  beside another arm\n";
  text += "and in it\n";
  for (const Event& event : programme.events) text += line_of(event);
  return text;
}

sim::FaultPlan cables_of(const Programme& programme) {
  sim::FaultPlan plan;
  plan.seed = programme.seed;
  plan.random = programme.setup.noise;
  for (const Event& event : programme.events) {
    const std::optional<sim::FaultKind> kind = fault_of(event.kind);
    if (!kind) continue;
    sim::ScriptedFault fault;
    fault.kind = *kind;
    fault.from = MonotonicTime{event.at};
    fault.lasts = event.lasts;
    fault.delay = event.lasts;  // of a delay: as much as it lasts
    plan.script.push_back(fault);
  }
  return plan;
}

}  // namespace thimble::campaign
