#pragma once

#include <string>
#include <vector>

#include "hal/base/result.hpp"

namespace thimble::linux {

struct GpioLineInfo {
  std::string name;  // may be empty
  bool is_taken{false};
  std::string consumer;  // who took it, in its own words; may be empty
  bool operator==(const GpioLineInfo&) const = default;
};

struct GpioChipInfo {
  std::string node;   // "/dev/gpiochip0"
  std::string label;  // "cp2112_gpio"
  std::vector<GpioLineInfo> lines;
  bool operator==(const GpioChipInfo&) const = default;
};

// The GPIO chip behind a node. It is opened and asked what it is: no line is taken, none changes.
// Errors: Permission, NotFound, System. Thread: any. Not RT.
[[nodiscard]] Result<GpioChipInfo> read_gpio_chip(const std::string& node);

}  // namespace thimble::linux
