// How a daemon ends: all that the kernel may hold up, within a patience.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "daemon/app/daemon.hpp"
#include "hal/base/contain.hpp"
#include "hal/linux/background_worker.hpp"

namespace thimble::app {

Result<void> Daemon::close(Duration patience) {
  // There may be no thread for what waits.
  return contain([&] { return close_all(patience); });
}

Result<void> Daemon::close_all(Duration patience) {
  const MonotonicTime deadline = clock_.now() + patience;
  const auto rest = [&] { return std::max(Duration(0), deadline - clock_.now()); };
  threads_.reset();
  server_.reset();
  commands_.reset();
  linux::BackgroundWorker worker;
  worker.post([this] { safety_.reset(); });
  if (!worker.wait(rest())) {
    return fail(Errc::Timeout, "the chip of the safety lines does not answer; ended without it");
  }
  if (Result<void> closed = close_arms(rest()); !closed) return closed;
  worker.post([this] {
    device_threads_.reset();
    guards_.reset();
    buses_.reset();
  });
  if (worker.wait(rest())) return {};
  return fail(Errc::Timeout, "the kernel holds up a device of a bus; ended without closing it");
}

Result<void> Daemon::close_arms(Duration patience) {
  const MonotonicTime deadline = clock_.now() + patience;
  runtime_.reset();
  std::vector<std::string> devices;
  if (device_threads_ != nullptr) devices = device_threads_->late_after(patience, clock_);
  const Duration rest = std::max(Duration(0), deadline - clock_.now());
  for (std::string& node : line_threads_.late_after(rest, clock_)) {
    devices.push_back(std::move(node));
  }
  std::string late;
  for (const std::string& device : devices) late += (late.empty() ? "" : ", ") + device;
  if (late.empty()) return {};
  return fail(Errc::Timeout, late + ": the kernel holds it up; ended without closing it");
}

}  // namespace thimble::app
