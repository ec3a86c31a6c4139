#pragma once

#include "drivers/falcon/falcon_model.hpp"
#include "hal/base/result.hpp"
#include "hal/bus/usb_descriptor.hpp"
#include "hal/plugin/driver.hpp"

namespace thimble::falcon {

// What a descriptor and the configuration together say: which arm, how strong a count is.
struct Match {
  const FalconModel* model{nullptr};  // never null in a result; a row of the table
  double newton_per_count{};
};

// Decides whether the device is one of ours and may be used, by its descriptor alone.
// Errors: as make_falcon_driver() says of probe(). Thread: any. Not RT. Pure.
[[nodiscard]] Result<Match> match(const bus::BusDeviceInfo& info,
                                  const plugin::DriverSettings& settings);

// The two bulk pipes; every packet counts, for the bytes behind the bridge are a stream.
[[nodiscard]] bus::UsbClaim claim();

}  // namespace thimble::falcon
