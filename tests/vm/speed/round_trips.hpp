#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"

namespace thimble::speed {

// How long exchanges took, in seconds: from a packet that is handed over until it came back. The
// device is opened for them and closed. Nothing when one never came back, or nothing opened.
// Thread: one; it asks again and again, and does not sleep: the bus's threads come before it.
[[nodiscard]] std::optional<std::vector<double>> hid_round_trips(bus::BusEnumerator& buses,
                                                                 const bus::DeviceAddress& address,
                                                                 const Clock& clock,
                                                                 std::size_t count);
[[nodiscard]] std::optional<std::vector<double>> usb_round_trips(bus::BusEnumerator& buses,
                                                                 const bus::DeviceAddress& address,
                                                                 const Clock& clock,
                                                                 std::size_t count);
[[nodiscard]] std::optional<std::vector<double>> serial_round_trips(
    bus::BusEnumerator& buses, const bus::DeviceAddress& address, const Clock& clock,
    std::size_t count);

}  // namespace thimble::speed
