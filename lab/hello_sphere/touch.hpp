#pragma once

#include <vector>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/coupling_case.hpp"

// A finger at the ball of thesis 3.2, through a coupling scheme.
namespace thimble::lab {

// SOURCE: config::SphereConfig, the ball of the example. World frame, y up.
inline constexpr double kBall_m = 0.020;  // radius
inline constexpr double kBallCenter_m = -0.025;
inline constexpr double kFloor_m = -0.045;
inline constexpr double kBallTop_m = kBallCenter_m + kBall_m;

enum class Gesture {
  Press,  // from 10 mm above down to 10 mm below its top, and 3 s there
  Stroke  // from its left over it to its right, 10 mm below its top, at 50 mm/s
};

struct TouchTick {
  double now_s{0};
  Position3 tip{};
  Force3 force{};  // wish, before the limiter
  Displacement3 offset{};
};

struct Touch {
  std::vector<TouchTick> ticks;  // each 1 ms, from the start of the gesture
  double generated_joule{0};     // most that the hand was given beyond what it gave
};

// Before time 0 the finger (lab/trial/finger.hpp) has rested where it starts until what the far end
// says has come. Deterministic. Errors: the scheme refuses the world.
[[nodiscard]] Result<Touch> touch_ball(const CouplingCase& of, Gesture gesture, double delay_s);

// The numbers of both gestures.
[[nodiscard]] std::vector<Parameter> touch_parameters();

// What a second of holding was like, the last of a press.
struct Held {
  double swing_m{0};   // of the tip, peak to peak, the most of the three axes
  double swing_hz{0};  // of that swing up and down; 0: none to be seen
  double mean_newton{0};
  double most_newton{0};
  double offset_m{0};  // of the frame at its end
};
[[nodiscard]] Held held(const Touch& press);

// Root mean square distance between the tips of two touches of one length, m.
[[nodiscard]] double distance_m(const Touch& a, const Touch& b);

}  // namespace thimble::lab
