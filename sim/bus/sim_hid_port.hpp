#pragma once

#include <cstdint>
#include <memory>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/bus/host_slot.hpp"
#include "sim/bus/sim_hid.hpp"
#include "sim/bus/sim_port.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::sim {

// The plug of one simulated HID device: runs its USB frames for as long as it exists.
//
// Every frame_period() of the model, counted from construction, it brings the model to the
// frame's time; while plugged it hands over the output report that was submitted before the
// frame began, then takes the input report and stamps it with the frame's time. So a report
// submitted in frame n moves no motor before n+1. While unplugged the model goes on without
// its bus (an arm still has its mass); where its supply went with the cable, its power is cut at
// both ends of that time.
//
// Thread: construction and destruction while nobody runs the clock; fire() from the thread
// that runs it; everything else from one control thread, which may be another.
// RT: a frame is as bounded as the model; it allocates nothing and takes no lock.
// Ownership: owns the model; the clock must outlive it, and it must outlive its SimHid.
class SimHidPort final : public SimPort, private Event {
 public:
  SimHidPort(VirtualClock& clock, bus::DeviceAddress address,
             std::unique_ptr<plugin::SimHidModel> model);

  [[nodiscard]] Result<std::unique_ptr<bus::HidDevice>> open_hid() override;
  [[nodiscard]] plugin::ArmBackend* arm_backend() noexcept override {
    return model_->arm_backend();
  }
  // After it returns no frame touches `host`. Waits at most for the frame under way.
  void detach(SimHid& host) noexcept { host_.detach(host); }

 private:
  THIMBLE_RT void fire(MonotonicTime now) noexcept override;
  THIMBLE_RT void exchange(SimHid* host, MonotonicTime now) noexcept;

  void drop_host() noexcept override;

  VirtualClock* clock_;
  std::unique_ptr<plugin::SimHidModel> model_;
  Duration frame_period_;
  HostSlot<SimHid> host_;
};

}  // namespace thimble::sim
