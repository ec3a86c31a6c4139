#pragma once

#include <memory>
#include <string>

#include "hal/base/result.hpp"
#include "hal/bus/gpio_lines.hpp"
#include "hal/linux/bus_settings.hpp"

namespace thimble::linux {

// The GPIO chips of this machine, over libgpiod. Each opened claim has a thread of the bus, since a
// chip behind USB takes milliseconds for a level and seconds when it hangs; its user never waits.
//
// Thread: one at a time; the lines as bus::GpioLines. Not RT.
// Ownership: the settings' clock must outlive the lines. Closing lines waits for the kernel.
class GpioChips final : public bus::GpioChips {
 public:
  // `folder` has the chips' nodes; another one is for tests.
  explicit GpioChips(BusSettings settings, std::string folder = "/dev")
      : settings_(std::move(settings)), folder_(std::move(folder)) {}

  // Edges are told from here on. It asks for each input's level, which are there when it returns: a
  // transfer for each over USB, seconds where the chip hangs, and no bound of ours. `wake` is
  // signalled by this call and then by the lines' thread, until they are closed. Errors: as
  // bus::GpioChips, and those of EventFd and RealtimeThread::start().
  [[nodiscard]] Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                             rt::WakeSignal* wake) override;

 private:
  BusSettings settings_;
  std::string folder_;
};

}  // namespace thimble::linux
