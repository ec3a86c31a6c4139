#include "drivers/spacemouse/pointer.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::spacemouse {
namespace {

constexpr double kDeadBand = 0.05;  // of the full deflection, ours: a worn puck rests beside 0

}  // namespace

void Pointer::forget() noexcept { *this = Pointer(full_counts_); }

void Pointer::push(const std::array<std::int16_t, 3>& counts, MonotonicTime at) noexcept {
  push_ = {counts, at};
}

void Pointer::turn(const std::array<std::int16_t, 3>& counts, MonotonicTime at) noexcept {
  turn_ = {counts, at};
}

double Pointer::share(std::int16_t counts) const noexcept {
  const double part = std::clamp(counts / full_counts_, -1.0, 1.0);
  const double beyond = std::max(0.0, (std::abs(part) - kDeadBand) / (1 - kDeadBand));
  return std::copysign(beyond * beyond, part);
}

bool Pointer::is_let_go() const noexcept {
  const auto rests = [this](std::int16_t counts) { return share(counts) == 0; };
  return std::all_of(push_.counts.begin(), push_.counts.end(), rests) &&
         std::all_of(turn_.counts.begin(), turn_.counts.end(), rests);
}

void Pointer::settle(MonotonicTime now) noexcept {
  if (calibration_ == CalibrationState::Ok) return;
  if (!is_let_go()) {
    let_go_since_ = now;
    calibration_ = CalibrationState::NeedsUser;
  } else if (now - let_go_since_ >= kSettle) {
    calibration_ = CalibrationState::Ok;
  }
}

void Pointer::advance(MonotonicTime now) noexcept {
  if (!is_started_) {
    is_started_ = true;
    now_ = now;
    let_go_since_ = now;
    return;  // still Unknown: a forgotten reference is seen to be gone
  }
  if (now - push_.at > kSilence) push_.counts = {};
  if (now - turn_.at > kSilence) turn_.counts = {};
  settle(now);
  const double dt_s = seconds(std::clamp(now - now_, Duration::zero(), kLongestStep));
  now_ = now;
  if (calibration_ != CalibrationState::Ok) return;
  const double step_m = kFullSpeed_m_per_s * dt_s;
  constexpr Position3 kCentre{};
  // Of the puck's axes right, towards the person, down.
  const Displacement3 way =
      position_ - kCentre +
      Displacement3{step_m * share(push_.counts[0]), -step_m * share(push_.counts[2]),
                    step_m * share(push_.counts[1])};
  const double length_m = norm(way);
  position_ = kCentre + (length_m > kRadius_m ? (kRadius_m / length_m) * way : way);
}

}  // namespace thimble::spacemouse
