#include "tests/contract/kernel_cable.hpp"

#include <poll.h>

#include <algorithm>
#include <cstdlib>

namespace thimble::test {

using std::chrono::milliseconds;

void KernelCable::start(std::function<void()> frame, int node) {
  thread_ = std::thread([this, frame = std::move(frame), node] { run(frame, node); });
}

void KernelCable::stop() {
  alone([this] { is_over_ = true; });
  if (thread_.joinable()) thread_.join();
}

void KernelCable::run(const std::function<void()>& frame, int node) {
  for (MonotonicTime next = machine_.now();; next = std::max(next + step_, machine_.now())) {
    const bool is_due = await(next, node);
    const std::scoped_lock lock(mutex_);
    if (is_over_) return;
    if (!is_due || is_held_.load()) continue;
    clock_.run_for(step_);
    if (frame) frame();
  }
}

bool KernelCable::await(MonotonicTime next, int node) {
  constexpr int kLook_ms = 10;  // whether it is over, or held
  if (node < 0) {
    machine_.sleep_until(next);
    return true;
  }
  pollfd kernel{is_held_.load() ? -1 : node, POLLIN, 0};  // -1: poll() passes it over
  return ::poll(&kernel, 1, kLook_ms) > 0;
}

void KernelCable::run_for(Duration duration) {
  constexpr Duration kWay = milliseconds(10);  // the daemon's threads, the kernel's, a frame each
  machine_.sleep_until(machine_.now() + 2 * duration + kWay);
}

bool KernelCable::comes_true(const std::function<bool()>& claim) {
  const MonotonicTime end = machine_.now() + std::chrono::seconds(20);
  while (!claim()) {
    if (machine_.now() > end) return false;
    machine_.sleep_until(machine_.now() + milliseconds(5));
  }
  return true;
}

bool KernelCable::lists(const bus::DeviceAddress& address) {
  const auto devices = buses_.list();
  return std::any_of(devices.begin(), devices.end(),
                     [&](const bus::BusDeviceInfo& info) { return info.address == address; });
}

bool attach_by_usbip(unsigned port) {
  const std::string command =
      "usbip --tcp-port " + std::to_string(port) + " attach -r 127.0.0.1 -b 1-1";
  return std::system(command.c_str()) == 0;
}

}  // namespace thimble::test
