#include "tests/vm/speed/servo_ticks.hpp"

#include "hal/linux/realtime_thread.hpp"
#include "tests/vm/speed/processor_time.hpp"

namespace thimble::speed {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(1);
constexpr std::size_t kMostTicks = 10'000;

std::optional<TickWork> ticked(Clock& clock, const std::function<bool()>& tick) {
  TickWork work;
  MonotonicTime next = clock.now() + kPeriod;
  clock.sleep_until(next);  // until whoever started this thread waits for it
  const double begin_s = process_processor_s();
  do {
    if (work.ticks == kMostTicks) return std::nullopt;
    next = next + kPeriod;
    clock.sleep_until(next);
    ++work.ticks;
  } while (tick());
  work.processor_s = process_processor_s() - begin_s;
  return work;
}

}  // namespace

std::optional<TickWork> run_servo_ticks(Clock& clock, const std::function<bool()>& tick) {
  std::optional<TickWork> work;
  linux::RealtimeThreadSettings settings;
  settings.name = "servo";
  auto thread = linux::RealtimeThread::start(settings, {}, [&] { work = ticked(clock, tick); });
  if (!thread) return std::nullopt;
  thread.value().reset();  // joins
  return work;
}

}  // namespace thimble::speed
