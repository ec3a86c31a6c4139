#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "hal/linux/bus_enumerator.hpp"
#include "hal/linux/monotonic_clock.hpp"
#include "sim/export/plug.hpp"

namespace thimble::test {

// A device that hangs on the kernel of this machine, with a thread that runs its frames, and the
// enumerator that finds it there. For a guest: it needs root, uhid and vhci-hcd, and no other
// device of the same serial number.
//
// Thread: that of the test; what the device's thread has, too, is touched within alone().
class KernelCable {
 public:
  explicit KernelCable(Duration step) : step_(step) {}
  ~KernelCable() { stop(); }
  KernelCable(const KernelCable&) = delete;
  KernelCable& operator=(const KernelCable&) = delete;

  [[nodiscard]] sim::PlugSurroundings surroundings() noexcept {
    return {&clock_, &machine_, &log_, &misbehaviour_};
  }
  // `frame`: what else is to be done in each step. `node`: where the kernel speaks to a device that
  // does nothing by itself: a step is run when it has said something, and no other. It must be open
  // until stop().
  void start(std::function<void()> frame = {}, int node = -1);
  void stop();  // nothing of the device runs afterwards
  template <class Work>
  decltype(auto) alone(Work work) {
    const std::scoped_lock lock(mutex_);
    return work();
  }
  // Nothing of the device runs while it is held: it answers nothing, as one that hangs.
  void hold(bool is_held) {
    alone([&] { is_held_.store(is_held); });
  }

  // Long enough for what takes that long on a wire to have come through kernel and threads.
  void run_for(Duration duration);
  // Whether it becomes so within 20 s.
  [[nodiscard]] bool comes_true(const std::function<bool()>& claim);
  [[nodiscard]] linux::BusEnumerator& buses() noexcept { return buses_; }
  [[nodiscard]] bool lists(const bus::DeviceAddress& address);

 private:
  void run(const std::function<void()>& frame, int node);
  // False: there is nothing to be done.
  [[nodiscard]] bool await(MonotonicTime next, int node);

  linux::MonotonicClock machine_;
  linux::BusEnumerator buses_{linux::BusSettings{machine_, {}, {}}};
  sim::VirtualClock clock_;
  sim::ModelLog log_{64};
  sim::Misbehaviour misbehaviour_{1};
  Duration step_;
  std::mutex mutex_;
  bool is_over_{false};
  std::atomic<bool> is_held_{false};
  std::thread thread_;
};

// The kernel's own tool: the device that is offered at `port` of this machine becomes one of its
// own. False: it did not.
[[nodiscard]] bool attach_by_usbip(unsigned port);

}  // namespace thimble::test
