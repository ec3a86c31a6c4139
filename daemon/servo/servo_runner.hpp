#pragma once

#include <atomic>

#include "daemon/servo/servo_loop.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::servo {

// Ticks `loop` at its rate on `clock` until `is_stopping`; then lets the arm go, whatever the
// controls still want, and goes on until the force has ramped to zero (ServoSettings::release_ramp)
// and zero has been sent for 5 ms. Periods that passed while the thread was late are skipped, never
// caught up in a burst.
//
// Thread: becomes the servo thread. RT: THIMBLE_RT_IO: its own system call is the sleep.
THIMBLE_RT_IO void run_servo(ServoLoop& loop, Clock& clock,
                             const std::atomic<bool>& is_stopping) noexcept;

}  // namespace thimble::servo
