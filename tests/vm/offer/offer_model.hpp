#pragma once

#include <cstdint>
#include <optional>

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"

namespace thimble::test {

// Offers a device to this machine's kernel until a signal ends it, frame by frame of the machine's
// clock: through uhid, or by USB/IP at that port of the loopback. `info`: how it is called.
// Errors: as UhidPlug and UsbipPlug.
Result<void> offer_model(plugin::SimHidModel& model, const bus::BusDeviceInfo& info,
                         std::optional<std::uint16_t> usbip_port);
Result<void> offer_model(plugin::SimUsbModel& model, const bus::BusDeviceInfo& info,
                         std::uint16_t usbip_port);
// As a CDC-ACM device.
Result<void> offer_model(plugin::SimSerialModel& model, const bus::BusDeviceInfo& info,
                         std::uint16_t usbip_port);

}  // namespace thimble::test
