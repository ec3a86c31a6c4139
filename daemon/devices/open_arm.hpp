#pragma once

#include <memory>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/plugin/driver_registry.hpp"

namespace thimble::devices {

// What `buses` lists at `address`. Thread: as BusEnumerator. Errors: NotFound, naming what is
// there; and, where `address` is the kernel's name of a port, as it was before decision 0507, how
// what is in that port is called now.
[[nodiscard]] Result<bus::BusDeviceInfo> find_device(bus::BusEnumerator& buses,
                                                     const bus::DeviceAddress& address);

// Lets the drivers claim the device that `found` describes, and opens it.
// Thread: as BusEnumerator. Errors: the driver's refusal with its name and the address in front.
[[nodiscard]] Result<std::unique_ptr<HapticDevice>> open_found(
    bus::BusEnumerator& buses, const plugin::DriverRegistry& drivers,
    const bus::BusDeviceInfo& found, const plugin::DriverSettings& settings);

// Finds the device at `address` on `buses`, lets the drivers claim it, opens it.
// Thread: as BusEnumerator. Errors: as find_device() and open_found().
[[nodiscard]] Result<std::unique_ptr<HapticDevice>> open_arm(
    bus::BusEnumerator& buses, const plugin::DriverRegistry& drivers,
    const bus::DeviceAddress& address, const plugin::DriverSettings& settings);

}  // namespace thimble::devices
