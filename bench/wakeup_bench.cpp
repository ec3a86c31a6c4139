// How late a real-time thread of ours wakes, beside cyclictest of rt-tests with the same priority,
// interval and CPU. Medians, in turns: the tails are those of the machine, not of either program.
#include <sys/wait.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/comparison.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "hal/linux/realtime_process.hpp"
#include "hal/linux/realtime_thread.hpp"

namespace {

using namespace thimble;

constexpr std::size_t kTurns = 5;
constexpr int kLongest_ns = 400'000;  // of cyclictest's histogram; later wake-ups count above it

// Of one second; in µs. Nothing without the rights of a real-time thread.
std::optional<double> own_median_us(int rate_hz, unsigned cpu,
                                    const linux::RealtimeReport& process) {
  bench::Slices late_us;
  late_us.reserve(static_cast<std::size_t>(rate_hz));
  const auto body = [&late_us, rate_hz] {
    linux::MonotonicClock clock;
    const Duration period = from_seconds(1.0 / rate_hz);
    MonotonicTime next = clock.now() + period;
    for (int i = 0; i < rate_hz; ++i) {
      late_us.push_back(1e6 * seconds(clock.sleep_until(next)));
      next = next + period;
    }
  };
  linux::RealtimeThreadSettings settings;
  settings.name = "bench-wakeup";
  settings.cpu = cpu;
  auto thread = linux::RealtimeThread::start(settings, process, body);
  if (!thread || !(*thread)->report().has_fifo) return std::nullopt;
  thread->reset();  // joins
  return bench::median(late_us);
}

// The middle of the histogram that cyclictest prints: lines of a bucket in ns and its count.
std::optional<double> median_of_histogram_us(std::FILE* lines) {
  std::vector<std::pair<long, long>> buckets;
  long total = 0;
  std::array<char, 256> line{};
  while (std::fgets(line.data(), line.size(), lines) != nullptr) {
    char* rest = nullptr;
    const long late_ns = std::strtol(line.data(), &rest, 10);
    if (rest == line.data()) continue;
    const long count = std::strtol(rest, nullptr, 10);
    total += count;
    if (count > 0) buckets.emplace_back(late_ns, count);
  }
  long seen = 0;
  for (const auto& [late_ns, count] : buckets) {
    seen += count;
    if (2 * seen >= total) return 1e-3 * static_cast<double>(late_ns);
  }
  return std::nullopt;
}

std::optional<double> cyclictest_median_us(int rate_hz, unsigned cpu) {
  const std::string command =
      "cyclictest -q -m -N -t 1 -p " + std::to_string(kServoPriority) + " -a " +
      std::to_string(cpu) + " -i " + std::to_string(1'000'000 / rate_hz) + " -l " +
      std::to_string(rate_hz) + " -h " + std::to_string(kLongest_ns) + " 2>/dev/null";
  std::FILE* const output = ::popen(command.c_str(), "r");
  if (output == nullptr) return std::nullopt;
  const std::optional<double> median_us = median_of_histogram_us(output);
  return ::pclose(output) == 0 ? median_us : std::nullopt;
}

bool run(int rate_hz, unsigned cpu, const linux::RealtimeReport& process) {
  bench::Slices ours_us;
  bench::Slices reference_us;
  bench::alternate(
      kTurns, [&] { ours_us.push_back(own_median_us(rate_hz, cpu, process).value_or(0)); },
      [&] { reference_us.push_back(cyclictest_median_us(rate_hz, cpu).value_or(0)); });
  if (bench::median(ours_us) <= 0 || bench::median(reference_us) <= 0) return false;
  const std::string name = "wake-up error, " + std::to_string(rate_hz) + " Hz, median";
  bench::print(bench::compare(name, "us", {bench::Goal::Of::Ratio, 1.1}, ours_us, reference_us));
  return true;
}

}  // namespace

int main() {
  const linux::RealtimeProcess process;
  const unsigned cpu = std::max(1U, std::thread::hardware_concurrency()) - 1;
  for (const int rate_hz : {1000, 2000, 4000, 8000}) {
    if (run(rate_hz, cpu, process.report())) continue;
    std::fputs("bench_wakeup: needs cyclictest (package rt-tests) and the right to SCHED_FIFO\n",
               stderr);
    return 1;
  }
  return 0;
}
