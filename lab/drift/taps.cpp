#include "lab/drift/taps.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/coupling/energy_observer.hpp"
#include "daemon/world/io/world_source.hpp"

namespace thimble::lab {
namespace {

// SOURCE: teleop.md section 4.
constexpr const char* kWorld = "box:3";
constexpr double kWall_m = 0.015;
constexpr double kFelt_newton = 0.5;
// Ours.
constexpr double kFar_m = 0.2;

class TappingHand {
 public:
  TappingHand(TrialLoop& loop, double delay_s)
      : loop_(loop), dt_s_(seconds(loop.dt())), began_s_(3 * delay_s + 0.1) {}

  // Until the frame and the far end are there.
  void rest() {
    while (now_s() < 0) tick(place_m());
  }
  [[nodiscard]] double now_s() const { return seconds(loop_.now().since_epoch) - began_s_; }
  void wait_until(double s) {
    while (now_s() < s) tick(place_m());
  }
  // Out and back; the offset at which it was felt. Negative: it was not.
  double tap() {
    double felt_m = -1;
    while (felt_m < 0) {
      if (x_m_ - place_m() > kFar_m) return -1;
      tick(x_m_ + dt_s_ * kTapHand_m_per_s);
      if (-felt_.force.x > kFelt_newton) felt_m = std::abs(felt_.offset.x);
    }
    // The frame is on its way back, and its place with it: there once is enough.
    for (bool is_back = false; !is_back;) {
      const double next_m = x_m_ - dt_s_ * kTapHand_m_per_s;
      is_back = next_m <= place_m();
      tick(std::max(next_m, place_m()));
    }
    return felt_m;
  }
  [[nodiscard]] double given_joule() const { return energy_.given_joule(); }

 private:
  // Where the tip is before the wall, as it is felt.
  [[nodiscard]] double place_m() const { return kWall_m - kTapFrom_m - felt_.offset.x; }
  void tick(double x_m) {
    const Velocity3 velocity{(x_m - x_m_) / dt_s_, 0, 0};
    energy_.add(felt_.force, velocity, loop_.dt());
    x_m_ = x_m;
    felt_ = loop_.tick({x_m, 0, 0}, velocity);
  }

  TrialLoop& loop_;
  double dt_s_;
  double began_s_;
  double x_m_{kWall_m - kTapFrom_m};
  coupling::ArmOutput felt_{};
  coupling::EnergyObserver energy_{};
};

}  // namespace

Result<Taps> run_taps(const TapRun& of) {
  const auto world = world::make_world(kWorld);
  if (!world) return tl::unexpected(world.error());
  CouplingCase as = of.of;
  as.settings.ghost_point.cell_m = (*world)->info().cell_m;
  as.settings.constraint_plane.cell_m = (*world)->info().cell_m;
  auto loop = make_trial(as, **world, {.impairment = {.delay_s = of.delay_s}});
  if (!loop) return tl::unexpected(loop.error());
  TappingHand hand(**loop, of.delay_s);
  hand.rest();
  Taps taps;
  double last_s = 0;
  for (std::uint64_t i = 0; i < of.taps; ++i) {
    hand.wait_until(static_cast<double>(i) / of.taps_per_s);
    last_s = hand.now_s();
    const double offset_m = hand.tap();
    if (offset_m < 0) break;
    taps.offsets_m.push_back(offset_m);
    if (offset_m > kFar_m) break;
  }
  if (taps.offsets_m.size() > 1) {
    taps.taps_per_s = static_cast<double>(taps.offsets_m.size() - 1) / last_s;
  }
  taps.generated_joule = hand.given_joule();
  return taps;
}

TapTheory tap_theory(double delay_s, double taps_per_s, link::SendMode mode) noexcept {
  const coupling::GhostPointSettings ghost;
  const double late_s = (mode == link::SendMode::LockStep ? 1.5 : 1) * delay_s;
  const double gain_m = std::max(0.0, kTapHand_m_per_s * late_s - ghost.hysteresis_m);
  const double r = ghost.relaxation_m_per_s;
  return {.gain_m = gain_m,
          .drift_m_per_s = std::max(0.0, taps_per_s * gain_m - r * (1 - taps_per_s * late_s)),
          .critical_per_s = r / (gain_m + r * late_s)};
}

double drift_m_per_s(const Taps& taps) noexcept {
  const std::size_t from = taps.offsets_m.size() / 4;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = from; i < taps.offsets_m.size(); ++i) {
    const double at_s = static_cast<double>(i) / taps.taps_per_s;
    n += 1;
    x += at_s;
    y += taps.offsets_m[i];
    xx += at_s * at_s;
    xy += at_s * taps.offsets_m[i];
  }
  return n < 2 ? 0 : (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace thimble::lab
