#pragma once

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"
#include "hal/plugin/sim_serial_model.hpp"
#include "hal/plugin/sim_usb_model.hpp"

namespace thimble::test {

enum class HidWay { Uhid, Usb };

// Offers a device to this machine's kernel until a signal ends it, frame by frame of the machine's
// clock: plugged into vhci-hcd, or through uhid. `info`: how it is called.
// Errors: as VhciPlug and UhidPlug.
Result<void> offer_model(plugin::SimHidModel& model, const bus::BusDeviceInfo& info, HidWay way);
Result<void> offer_model(plugin::SimUsbModel& model, const bus::BusDeviceInfo& info);
// As a CDC-ACM device.
Result<void> offer_model(plugin::SimSerialModel& model, const bus::BusDeviceInfo& info);

}  // namespace thimble::test
