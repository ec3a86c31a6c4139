#include "bench/reference_tick.hpp"

// In a file of its own, so that the compiler cannot see through the loop that calls it.
void ReferenceTick::tick() noexcept {
  position_m_ = position_m_ > 0.016 ? 0.015 : position_m_ + 0.0001;
  const double depth_m = position_m_ - 0.015;
  const double wish_newton = depth_m > 0 ? -800.0 * depth_m : 0.0;
  sum_newton_ += wish_newton < -8.0 ? -8.0 : wish_newton;
}
