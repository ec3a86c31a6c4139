// What one tick of the servo costs in process: a device that answers at once, the ghost-point
// arm half pressing on a wall, limiter, recorder, publication. Beside it the same force law in
// a few lines of plain code, as a measure of this machine.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "bench/comparison.hpp"
#include "bench/reference_tick.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/servo/servo_loop.hpp"
#include "hal/linux/monotonic_clock.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kTicks = 20000;

class SteppingClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    now_ = deadline;
    return {};
  }

 private:
  MonotonicTime now_{std::chrono::seconds(1)};
};

class InstantDevice final : public HapticDevice {
 public:
  explicit InstantDevice(const Clock& clock) : clock_(clock) {
    capabilities_.peak_force_newton = 8;
    state_.calibration = CalibrationState::Ok;
    for (std::size_t i = 0; i < 3; ++i) state_.motor_current_per_force.row[i][i] = 0.1;
  }
  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override { return ""; }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return {}; }
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override { return {}; }
  void forget_calibration() noexcept override {}
  IoStatus read(HapticState& out) noexcept override {
    state_.sampled_at = clock_.now();
    ++state_.sample_sequence;
    // 0.2 to 0.5 mm inside the wall, a different place each tick.
    state_.tip.x = 0.0152 + 0.0001 * static_cast<double>(state_.sample_sequence % 4);
    out = state_;
    return IoStatus::Ok;
  }
  IoStatus write(const LimitedWrench& wrench) noexcept override {
    sum_ += wrench.force().x;
    return IoStatus::Ok;
  }

 private:
  const Clock& clock_;
  HapticCapabilities capabilities_;
  HapticState state_{};
  double sum_{0};
};

class WallLink final : public coupling::ArmLink {
 public:
  WallLink() {
    set_.planes.push_back({.normal = {1, 0, 0}, .offset_m = 0.015});
    set_.session = 1;
  }
  void send(const coupling::HandSample& sample) noexcept override { last_ = sample.sequence; }
  bool receive(coupling::ConstraintSet& out) noexcept override {
    ++set_.sequence;
    set_.answers = last_;
    out = set_;
    return true;
  }
  [[nodiscard]] coupling::LinkQuality quality() const noexcept override {
    return {true, std::chrono::milliseconds(1), {}};
  }

 private:
  coupling::ConstraintSet set_{};
  std::uint64_t last_{0};
};

struct Figures {
  bench::Slices p50_ns;
  bench::Slices p999_ns;
};

// Each tick between two readings of the clock: one reading is part of every figure.
template <class Tick>
void measure(const Tick& tick, Figures& figures) {
  std::vector<double> costs_ns;
  costs_ns.reserve(kTicks);
  for (std::size_t i = 0; i < kTicks; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    tick();
    const auto end = std::chrono::steady_clock::now();
    costs_ns.push_back(std::chrono::duration<double, std::nano>(end - begin).count());
  }
  std::sort(costs_ns.begin(), costs_ns.end());
  figures.p50_ns.push_back(costs_ns[kTicks / 2]);
  figures.p999_ns.push_back(costs_ns[kTicks - kTicks / 1000]);
}

servo::ServoSettings settings() {
  servo::ServoSettings settings;
  settings.limiter.max_force_newton = 8;
  settings.limiter.peak_current_a = {3, 3, 3};
  settings.limiter.continuous_current_a = {1, 1, 1};
  return settings;
}

}  // namespace

int main() {
  SteppingClock clock;
  linux::MonotonicClock stopwatch;
  InstantDevice device(clock);
  WallLink link;
  coupling::GhostPointArm arm{coupling::GhostPointSettings{}};
  servo::ServoControls controls;
  controls.want_active = true;
  servo::ServoLoop loop({device, arm, link, controls, clock, stopwatch}, settings());
  const auto tick = [&] {
    clock.sleep_until(clock.now() + settings().period());
    loop.tick({});
  };
  for (int i = 0; i < 2000; ++i) tick();

  ReferenceTick plain;
  Figures ours;
  Figures reference;
  bench::alternate(
      bench::kSlices, [&] { measure(tick, ours); },
      [&] { measure([&] { plain.tick(); }, reference); });

  servo::ServoSnapshot snapshot;
  if (!loop.snapshot(snapshot) || !snapshot.frame.is_in_contact || snapshot.faults != 0) {
    std::fputs("bench_servo_tick: the arm does not press on its wall\n", stderr);
    return 1;
  }
  using Of = bench::Goal::Of;
  bench::print(
      bench::compare("servo tick, median", "ns", {Of::Value, 300}, ours.p50_ns, reference.p50_ns));
  bench::print(bench::compare("servo tick, 99.9 %", "ns", {Of::Value, 1000}, ours.p999_ns,
                              reference.p999_ns));
  return 0;
}
