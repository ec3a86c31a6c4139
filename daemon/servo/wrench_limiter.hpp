#pragma once

#include <array>
#include <cstdint>

#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/device/fault.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/device/limited_wrench.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// What a configuration may say about the limits of one arm. It can only tighten: see
// make_limiter_settings().
struct LimitRequest {
  double force_newton{0};          // 0: the arm's own peak
  double rise_newton_per_s{1000};  // DESIGN section 4
};

struct LimiterSettings {
  double max_force_newton{0};
  double max_rise_newton_per_s{1000};      // falls are never limited
  std::array<double, 3> peak_current_a{};  // per joint
  std::array<double, 3> continuous_current_a{};
  // Time in which a motor held at its continuous current reaches 63 % of its final heat.
  // Ours: small DC motors of this class have winding time constants of 10 to 20 s (Maxon RE25
  // class); the short end cuts earlier.
  Duration motor_time_constant{std::chrono::seconds(10)};
};

// Joins the arm's limits and the request; an arm without motors gets no force. InvalidArgument when
// a limit is neither told by the arm nor configured, or when the request would loosen one.
[[nodiscard]] Result<LimiterSettings> make_limiter_settings(const HapticCapabilities& arm,
                                                            const LimitRequest& request);

struct LimiterInput {
  Force3 wish{};                      // N, at the tip, base frame
  Matrix3 motor_current_per_force{};  // A/N, of the present pose
  double gain{0};                     // 0..1: activation ramp, deadman, hold and ramp-out
  Duration dt{};                      // since the previous call, > 0; see kLongestRise
};

struct LimiterOutput {
  LimitedWrench wrench{};
  FaultCode fault{FaultCode::None};  // NonFiniteForce or NonFiniteState; the wrench is zero then
  bool is_norm_clamped{false};
  bool is_rise_limited{false};
  bool is_current_clamped{false};
  bool is_heat_limited{false};
};

// The last stage before the wire, and the only maker of a non-zero LimitedWrench. Rejects NaN
// and infinity, clamps the norm and every joint's motor current without turning the force,
// limits the rise, models motor heat.
//
// The rise is limited for every change that is not a fall: from the point of the segment
// between zero and the previous force that is nearest to the wish, the force moves towards the
// wish by at most rise · dt. So it may drop to zero at once, but a reversal starts from zero.
//
// Heat of a motor: dh/dt = ((I / I_continuous)^2 - h) / tau, h = 1 at the continuous limit.
// Above h = 0.9 the allowed current falls linearly from peak to continuous at h = 1.
//
// Thread: the servo thread. RT: THIMBLE_RT. Errors: LimiterOutput::fault.
class WrenchLimiter {
 public:
  // A late servo may not make up in one call for the rise that it missed; heat counts all of dt.
  static constexpr Duration kLongestRise = std::chrono::milliseconds(2);

  explicit WrenchLimiter(const LimiterSettings& settings) noexcept : settings_(settings) {}

  THIMBLE_RT LimiterOutput limit(const LimiterInput& input) noexcept;
  // Zero now; the next force rises from zero. Motor heat goes on cooling over `dt`.
  THIMBLE_RT LimitedWrench cut(Duration dt) noexcept;
  [[nodiscard]] const std::array<double, 3>& motor_heat() const noexcept { return heat_; }

 private:
  [[nodiscard]] double allowed_current_a(std::size_t joint) const noexcept;
  void advance_heat(const std::array<double, 3>& current_a, Duration dt) noexcept;

  LimiterSettings settings_;
  Force3 previous_{};
  std::array<double, 3> heat_{};
};

}  // namespace thimble::servo
