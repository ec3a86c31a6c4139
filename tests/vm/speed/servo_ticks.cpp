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

bool run_as_servo(const std::function<void()>& body) {
  linux::RealtimeThreadSettings settings;
  settings.name = "servo";
  auto thread = linux::RealtimeThread::start(settings, {}, body);
  if (!thread) return false;
  thread.value().reset();  // joins
  return true;
}

std::optional<TickWork> run_servo_ticks(Clock& clock, const std::function<bool()>& tick) {
  std::optional<TickWork> work;
  if (!run_as_servo([&] { work = ticked(clock, tick); })) return std::nullopt;
  return work;
}

}  // namespace thimble::speed
