#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/driver.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// What plugins of every bus are refused for, and refuse with. Thread: any non-RT one.
// What match() answered: NotMine, or InvalidArgument with its words.
[[nodiscard]] Result<void> check_match(std::int32_t status, const thimble_reason& reason);
// What open() answered: InvalidArgument with its words, or Malformed without a device.
[[nodiscard]] Result<void> check_opened(std::int32_t status, const void* device,
                                        const thimble_reason& reason);
// Permission for a real device that the configuration does not name.
[[nodiscard]] Result<void> check_named(const bus::BusDeviceInfo& info,
                                       const DriverSettings& settings);

}  // namespace thimble::plugin
