// The daemon as a person meets it: from its start to the first tick, as the status tells, and the
// memory it holds when it has run for a second.
#include <chrono>
#include <cstdio>
#include <thread>

#include "bench/comparison.hpp"
#include "bench/daemon_process.hpp"
#include "bench/process_memory.hpp"
#include "bench/reference_spawn.hpp"

namespace {

using namespace thimble;

constexpr double kMebi = 1024.0 * 1024.0;

struct Figures {
  bench::Slices start_ms;
  bench::Slices resident_mib;
  bool is_memory_locked{true};
  bool has_failed{false};
};

void start_once(Figures& figures) {
  const auto begin = std::chrono::steady_clock::now();
  const bench::DaemonProcess daemon;
  if (!daemon.is_started() || !daemon.wait_for_first_tick()) {
    figures.has_failed = true;
    return;
  }
  const auto end = std::chrono::steady_clock::now();
  figures.start_ms.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
  std::this_thread::sleep_for(std::chrono::seconds(1));
  figures.resident_mib.push_back(bench::process_bytes(daemon.id(), "VmRSS").value_or(0) / kMebi);
  if (!(bench::process_bytes(daemon.id(), "VmLck").value_or(0) > 0)) {
    figures.is_memory_locked = false;
  }
}

}  // namespace

int main() {
  Figures figures;
  bench::Slices spawn_ms;
  bench::alternate(
      bench::kSlices, [&] { start_once(figures); },
      [&] { spawn_ms.push_back(1e3 * reference_spawn_s()); });
  if (figures.has_failed) {
    std::fputs("bench_daemon: thimbled does not tick; run this from the top of the tree\n", stderr);
    return 1;
  }
  using Of = bench::Goal::Of;
  bench::print(
      bench::compare("start to first tick", "ms", {Of::Value, 150}, figures.start_ms, spawn_ms));
  const char* const name =
      figures.is_memory_locked ? "resident, memory locked" : "resident, memory NOT locked";
  bench::print(bench::compare(name, "MiB", {Of::Value, 40}, figures.resident_mib, {}));
  return 0;
}
