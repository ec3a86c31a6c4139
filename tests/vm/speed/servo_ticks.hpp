#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "hal/base/time.hpp"

namespace thimble::speed {

// Runs `body` on a thread of a servo's class and priority, which are those of a bus's threads too:
// it must sleep for what it waits for. False: there is no thread. Thread: any; waits for its end.
[[nodiscard]] bool run_as_servo(const std::function<void()>& body);

struct TickWork {
  std::size_t ticks{0};
  double processor_s{0};  // of all threads of this process, the sleep between ticks with it
};

// Calls `tick` each millisecond, as a servo, until it says false. Nothing when it does not for
// 10 s, or there is no thread. Thread: any; waits for it.
[[nodiscard]] std::optional<TickWork> run_servo_ticks(Clock& clock,
                                                      const std::function<bool()>& tick);

}  // namespace thimble::speed
