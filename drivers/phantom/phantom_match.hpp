#pragma once

#include <optional>

#include "drivers/phantom/phantom_codec.hpp"
#include "drivers/phantom/phantom_model.hpp"
#include "hal/base/result.hpp"
#include "hal/plugin/driver.hpp"

namespace thimble::phantom {

// What a descriptor and the configuration together say: which arm, which firmware.
struct Match {
  const PhantomModel* model{nullptr};  // never null in a result; a row of the table
  double amplifier_max_a{};
  std::optional<ReportForm> form{};  // of HID; nothing: the text protocol
};

// Decides whether the device is one of ours and may be used, by its descriptor alone.
// Errors: as make_phantom_driver() says of probe(). Thread: any. Not RT. Pure.
[[nodiscard]] Result<Match> match(const bus::BusDeviceInfo& info,
                                  const plugin::DriverSettings& settings);

}  // namespace thimble::phantom
