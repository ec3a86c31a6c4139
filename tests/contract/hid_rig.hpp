#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/hid_device.hpp"

namespace thimble::test {

// One implementation of bus::HidDevice together with the far end of its wire.
class HidRig {
 public:
  virtual ~HidRig() = default;
  virtual bus::HidDevice& device() = 0;
  virtual void close_device() = 0;
  // Queues one input report; the device sends one per frame and nothing when it has none.
  virtual void device_sends(std::span<const std::uint8_t> report) = 0;
  // Every output report the device got, oldest first.
  virtual std::vector<std::vector<std::uint8_t>> received_by_device() = 0;
  virtual void unplug() = 0;
  virtual void run_for(Duration duration) = 0;
  [[nodiscard]] virtual std::size_t input_report_bytes() const = 0;
  // What is shorter may be lost on the way.
  [[nodiscard]] virtual std::size_t least_report_bytes() const { return 1; }
  [[nodiscard]] virtual std::size_t output_report_bytes() const = 0;
  [[nodiscard]] virtual Duration frame_period() const = 0;
};

// How the suite makes a fresh rig for every test.
struct HidRigFactory {
  std::string name;
  std::unique_ptr<HidRig> (*make)();
  friend void PrintTo(const HidRigFactory& factory, std::ostream* out) { *out << factory.name; }
};

}  // namespace thimble::test
