#include "lab/stability/release.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "daemon/coupling/energy_observer.hpp"
#include "daemon/servo/velocity_filter.hpp"
#include "daemon/world/voxel_world.hpp"

namespace thimble::lab {
namespace {

// Ours: deep enough for the softest wall, K = 2 N/m.
constexpr std::uint32_t kCells = 32;
constexpr double kCell_m = 0.003;
constexpr std::int32_t kFirstOfWall = kCells / 2;
constexpr double kKick_m_per_s = 1e-4;
constexpr double kBrake_newton_s_per_m = 10;
constexpr double kBefore_m = -0.001;
constexpr double kAway_m = 0.04;  // nothing stable goes so far
// Ours: a thousandth of the kick is rest, whatever rounding leaves.
constexpr double kAtRest_m_per_s = 1e-7;
constexpr double kShrinks = 0.98;
constexpr double kTick_s = 1e-3;

std::unique_ptr<world::VoxelWorld> wall_of(double newton_per_m) {
  auto grid = world::VoxelGrid::create({kCells, kCells, kCells}, kCell_m);
  if (!grid) return nullptr;
  const auto cells = static_cast<std::int32_t>(kCells);
  for (std::int32_t z = 0; z < cells; ++z) {
    for (std::int32_t y = 0; y < cells; ++y) (void)grid->set_row({kFirstOfWall, y, z}, cells, true);
  }
  return std::make_unique<world::VoxelWorld>(
      *std::move(grid), "the lab's wall",
      world::MaterialMap(world::Material{.stiffness = {newton_per_m}}));
}

// m·dv/dt = F − b·v, exact for a force that is held.
class Mass {
 public:
  Mass(double kg, double at_m) : x_m(at_m), kg_(kg) {}

  void move(double newton, double damping_newton_s_per_m) {
    const double rate_per_s = damping_newton_s_per_m / kg_;
    const double lost = -std::expm1(-rate_per_s * kTick_s);
    // (1 − exp(−r·t))/r, and its limit.
    const double lasts_s = rate_per_s > 0 ? lost / rate_per_s : kTick_s;
    const double drift_s2 =
        rate_per_s > 0 ? (kTick_s - lasts_s) / rate_per_s : kTick_s * kTick_s / 2;
    x_m += v_m_per_s * lasts_s + newton / kg_ * drift_s2;
    v_m_per_s += newton / kg_ * lasts_s - v_m_per_s * lost;
  }

  double x_m;
  double v_m_per_s{0};

 private:
  double kg_;
};

class Trial {
 public:
  Trial(const Release& how, TrialLoop& loop)
      : how_(how), loop_(loop), mass_(how.mass_kg, std::min(kBefore_m, how.depth_m)) {}

  // Held still before the wall and where it is to begin, each until what the far end says of it has
  // come; then braked until it rests.
  void settle() {
    const double held_s = 0.05 + 3 * how_.delay_s;
    const double braked_s = 2 + 20 * how_.delay_s;
    while (now_s_ < held_s) tick(true, 0);
    mass_.x_m = how_.depth_m;
    while (now_s_ < 2 * held_s) tick(true, 0);
    const double brake = std::max(kBrake_newton_s_per_m, how_.damping_newton_s_per_m);
    while (now_s_ < 2 * held_s + braked_s && !is_away()) tick(false, brake);
  }
  Released swing() {
    // Many periods of the slowest swing, which is that of the delay.
    const double all_s = 4 + 40 * how_.delay_s;
    const double from_s = now_s_;
    double middle = 0;
    double last = 0;
    mass_.v_m_per_s += kKick_m_per_s;
    coupling::EnergyObserver energy;
    while (now_s_ - from_s < all_s && !is_away()) {
      tick(false, how_.damping_newton_s_per_m);
      energy.add(force_, {mass_.v_m_per_s, 0, 0}, loop_.dt());
      if (now_s_ - from_s < all_s / 3) continue;
      double& window = now_s_ - from_s < 2 * all_s / 3 ? middle : last;
      window = std::max(window, std::abs(mass_.v_m_per_s));
    }
    const bool shrinks = last < kAtRest_m_per_s || last < kShrinks * middle;
    return {.is_stable = !is_away() && shrinks, .generated_joule = energy.generated_joule()};
  }

 private:
  void tick(bool is_held, double damping_newton_s_per_m) {
    now_s_ = seconds(loop_.now().since_epoch);
    const Velocity3 seen = filter_.update(loop_.now(), {mass_.x_m, 0, 0});
    force_ = loop_.tick({mass_.x_m, kBeside_m, kBeside_m}, seen).force;
    if (is_held) return;
    mass_.move(how_.push_newton + force_.x, damping_newton_s_per_m);
  }
  [[nodiscard]] bool is_away() const { return !(std::abs(mass_.x_m) < kAway_m); }

  static constexpr double kBeside_m = kCell_m / 2;  // ours: not where four cells meet
  Release how_;
  TrialLoop& loop_;
  Mass mass_;
  servo::VelocityFilter filter_{};
  Force3 force_{};
  double now_s_{0};
};

}  // namespace

Result<Released> let_go(const Release& how) {
  const auto world = wall_of(how.wall_newton_per_m);
  if (!world) return fail(Errc::System, "the lab's wall cannot be made");
  CouplingCase as = how.of;
  as.settings.ghost_point.cell_m = kCell_m;
  as.settings.constraint_plane.cell_m = kCell_m;
  auto loop = make_trial(as, *world, {.impairment = {.delay_s = how.delay_s}});
  if (!loop) return tl::unexpected(loop.error());
  Trial trial(how, **loop);
  trial.settle();
  return trial.swing();
}

std::vector<Parameter> release_parameters() {
  return {{"cell", "m", kCell_m},
          {"kick", "m/s", kKick_m_per_s},
          {"brake", "N.s/m", kBrake_newton_s_per_m},
          {"clear_of_wall", "m", kClear_m},
          {"swings_away_beyond", "m", kAway_m},
          {"shrinks_below", "", kShrinks}};
}

}  // namespace thimble::lab
