#pragma once

#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/device/haptic_device.hpp"

namespace thimble::devices {

// Whether what stands at a lost arm's address is the arm that left. Limits, motor heat and
// workspace of the session were derived from that one, so another must not inherit them.
//
// Thread: any. Not RT. Pure. Errors: InvalidArgument, saying what differs and what to do.

// By the descriptor, before anything is sent to it. Names of maker and product are not compared.
[[nodiscard]] Result<void> check_same_device(const bus::BusDeviceInfo& left,
                                             const bus::BusDeviceInfo& returned);
// By what its driver found when it was opened.
[[nodiscard]] Result<void> check_same_limits(const HapticCapabilities& left,
                                             const HapticCapabilities& returned);

}  // namespace thimble::devices
