#pragma once

#include <cstddef>
#include <optional>

#include "hal/base/time.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "tests/vm/speed/round_trip_figures.hpp"

namespace thimble::speed {

// What `count` exchanges took by the clock, and as many more by the processor time of all threads
// of the process. The device is opened for them and closed. Nothing when one never came back, or
// nothing opened.
//
// By the clock the mailbox is asked again and again, without a sleep, by a thread that those of the
// bus come before. By processor time it is a servo's: once a tick of a millisecond, and what the
// ticks take where there is no device is left out of it (docs/decisions/0496).
// Thread: one; waits.
[[nodiscard]] std::optional<RoundTripFigures> hid_round_trips(bus::BusEnumerator& buses,
                                                              const bus::DeviceAddress& address,
                                                              Clock& clock, std::size_t count);
[[nodiscard]] std::optional<RoundTripFigures> usb_round_trips(bus::BusEnumerator& buses,
                                                              const bus::DeviceAddress& address,
                                                              Clock& clock, std::size_t count);
[[nodiscard]] std::optional<RoundTripFigures> serial_round_trips(bus::BusEnumerator& buses,
                                                                 const bus::DeviceAddress& address,
                                                                 Clock& clock, std::size_t count);

}  // namespace thimble::speed
