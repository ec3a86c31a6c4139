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
  explicit GpioChips(BusSettings settings, std::string folder = "/dev")
      : settings_(std::move(settings)), folder_(std::move(folder)) {}

  // Edges are told from here on; the levels are there when it returns.
  [[nodiscard]] Result<std::unique_ptr<bus::GpioLines>> open(const bus::GpioClaim& claim,
                                                             rt::WakeSignal* wake) override;

 private:
  BusSettings settings_;
  std::string folder_;
};

}  // namespace thimble::linux
