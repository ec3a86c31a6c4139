#pragma once

#include <array>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/arm/motor_amplifier.hpp"

namespace thimble::sim {

// Whole quadrature counts since some fixed pose, never wrapping: what the wheels have turned.
using EncoderTotals = std::array<std::int64_t, 6>;

// A controller board as the arm knows it, whatever it speaks with a host.
// Thread: one. RT: all.
class ControllerBoard {
 public:
  virtual ~ControllerBoard() = default;
  // Counters are zero at whatever pose the arm has now. `boot`: how long it is deaf at first.
  THIMBLE_RT virtual void power_up(MonotonicTime t, Duration boot,
                                   const EncoderTotals& totals) noexcept = 0;
  // Does everything that falls due until `t`, with the encoders as they are at `t`.
  THIMBLE_RT virtual void run_until(MonotonicTime t, const EncoderTotals& totals) noexcept = 0;
  // The levels of the two buttons.
  THIMBLE_RT virtual void set_calibration_button(bool pressed) noexcept = 0;
  THIMBLE_RT virtual void set_stylus_button(bool pressed) noexcept = 0;
  [[nodiscard]] virtual const MotorAmplifier& amplifier() const noexcept = 0;
};

}  // namespace thimble::sim
