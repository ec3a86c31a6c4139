#pragma once

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/driver.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::plugin {

// What plugins of every bus are refused for, and refuse with. Thread: control plane. Not RT.
[[nodiscard]] tl::unexpected<Error> refusal_of(const thimble_reason& reason);
// Permission for a real device that the configuration does not name.
[[nodiscard]] Result<void> check_named(const bus::BusDeviceInfo& info,
                                       const DriverSettings& settings);

}  // namespace thimble::plugin
