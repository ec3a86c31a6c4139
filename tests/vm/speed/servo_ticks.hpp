#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::speed {

struct TickWork {
  std::size_t ticks{0};
  double processor_s{0};  // of all threads of this process, the sleep between ticks with it
};

// Calls `tick` each millisecond on a thread of a servo's class until it says false. Nothing when it
// does not for 10 s, or there is no thread. Thread: any; waits for it.
[[nodiscard]] std::optional<TickWork> run_servo_ticks(Clock& clock,
                                                      const std::function<bool()>& tick);

}  // namespace thimble::speed
