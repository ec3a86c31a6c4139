#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lab/compare/judged.hpp"
#include "lab/compare/scenarios.hpp"

// The scenarios of a hand that nothing stops: taps, and a shake in free space.
namespace thimble::lab {
namespace {

// SOURCE: teleop.md section 5, M8. Ours: from where, how fast, how often.
constexpr std::array kTaps_s{0.030, 0.060, 0.120, 0.250};
constexpr int kTapsOfEach = 4;
constexpr double kTapFrom_m = kWall_m - 0.005;
constexpr double kTapSpeed_m_per_s = 0.2;
constexpr double kTapFelt_newton = 0.5;
constexpr double kTapAfter_s = 0.02;  // ours: felt so soon after, it is still of the tap
constexpr double kPause_s = 0.3;
constexpr double kLongestPause_s = 3;
constexpr double kReturned_m = 0.002;  // teleop.md 4: "relaxed"

// Ours: as fast as a hand that explores.
constexpr double kShake_hz = 2;
constexpr double kShake_m = 0.005;
constexpr double kShakeMiddle_m = -0.015;
constexpr double kShakeSettles_s = 1;
constexpr double kShakeFor_s = 3;

// Waits before the wall until the frame has returned.
void pause(Stage& stage, double at_least_s) {
  const double from_s = stage.now_s();
  for (;;) {
    const Felt& felt = stage.tick({kTapFrom_m, kBeside_m, 0}, {});
    const double waited_s = felt.now_s - from_s;
    const double offset_m = norm(felt.offset.x, felt.offset.y, felt.offset.z);
    if (waited_s >= kLongestPause_s || (waited_s >= at_least_s && offset_m <= kReturned_m)) return;
  }
}

// Out and back, `behind_s` of it behind the face. Whether it was felt, beyond what drags before it.
bool tap(Stage& stage, double behind_s) {
  const double from_s = stage.now_s();
  const double turn_s = (kWall_m - kTapFrom_m) / kTapSpeed_m_per_s + behind_s / 2;
  const double end_s = turn_s + behind_s / 2 + kTapAfter_s;
  bool is_felt = false;
  double drag_newton = 0;
  for (double t_s = 0; t_s < end_s; t_s = stage.now_s() - from_s) {
    const bool is_out = t_s < turn_s;
    const double way_m = kTapSpeed_m_per_s * (is_out ? t_s : 2 * turn_s - t_s);
    const double speed_m_per_s = is_out ? kTapSpeed_m_per_s : -kTapSpeed_m_per_s;
    const Felt& felt = stage.tick({kTapFrom_m + way_m, kBeside_m, 0}, {speed_m_per_s, 0, 0});
    const bool is_before = is_out && kTapFrom_m + way_m < kWall_m;
    if (is_before) drag_newton = std::max(drag_newton, -felt.force.x);
    is_felt = is_felt || (!is_before && -felt.force.x > drag_newton + kTapFelt_newton);
  }
  return is_felt;
}

}  // namespace

Result<void> play_taps(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  auto stage = Stage::create(of, settings, {kTapFrom_m, kBeside_m, 0});
  if (!stage) return tl::unexpected(stage.error());
  int missed = 0;
  int turn = 0;
  for (int round = 0; round < kTapsOfEach; ++round) {
    for (const double behind_s : kTaps_s) {
      // So that a tap meets each phase of what the network does.
      pause(**stage, kPause_s + 0.013 * ++turn);
      if (!tap(**stage, behind_s)) ++missed;
    }
  }
  into.missed_share = static_cast<double>(missed) / (kTapsOfEach * kTaps_s.size());
  judge_changes((*stage)->history(), into);
  return {};
}

Result<void> play_shake(const CouplingCase& of, const StageSettings& settings, Measures& into) {
  auto stage = Stage::create(of, settings, {kShakeMiddle_m, kBeside_m, 0});
  if (!stage) return tl::unexpected(stage.error());
  const double omega_per_s = 2 * std::numbers::pi * kShake_hz;
  double force_by_acceleration = 0;
  double acceleration_squared = 0;
  while ((*stage)->now_s() < kShakeFor_s) {
    const double angle_rad = omega_per_s * ((*stage)->now_s() + 1e-3);
    const double away_m = kShake_m * std::sin(angle_rad);
    const double speed_m_per_s = kShake_m * omega_per_s * std::cos(angle_rad);
    const Felt& felt =
        (*stage)->tick({kShakeMiddle_m + away_m, kBeside_m, 0}, {speed_m_per_s, 0, 0});
    if (felt.now_s < kShakeSettles_s) continue;
    const double acceleration = -omega_per_s * omega_per_s * away_m;
    force_by_acceleration += felt.force.x * acceleration;
    acceleration_squared += acceleration * acceleration;
  }
  into.mass_kg = -force_by_acceleration / acceleration_squared;
  return {};
}

void list_motions(std::vector<Parameter>& into) {
  for (std::size_t i = 0; i < kTaps_s.size(); ++i) {
    into.push_back({"taps: behind_wall_for_" + std::to_string(i + 1), "s", kTaps_s[i]});
  }
  into.insert(into.end(), {{"taps: of_each", "", double{kTapsOfEach}},
                           {"taps: before_wall", "m", kWall_m - kTapFrom_m},
                           {"taps: speed", "m/s", kTapSpeed_m_per_s},
                           {"taps: felt_from", "N", kTapFelt_newton},
                           {"taps: felt_within", "s", kTapAfter_s},
                           {"taps: pause", "s", kPause_s},
                           {"taps: longest_pause", "s", kLongestPause_s},
                           {"taps: returned_within", "m", kReturned_m},
                           {"shake: rate", "Hz", kShake_hz},
                           {"shake: stroke", "m", kShake_m},
                           {"shake: before_wall", "m", kWall_m - kShakeMiddle_m},
                           {"shake: settles", "s", kShakeSettles_s},
                           {"shake: for", "s", kShakeFor_s}});
}

}  // namespace thimble::lab
