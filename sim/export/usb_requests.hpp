#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/bus/usb_device.hpp"
#include "sim/export/usb_descriptors.hpp"

namespace thimble::sim {

// The eight bytes of a setup packet (USB 2.0, table 9-2), with as much of `data` as a request has
// room for. Total. Thread: any. Pure.
[[nodiscard]] bus::UsbControlRequest control_request(const std::array<std::uint8_t, 8>& setup,
                                                     std::span<const std::uint8_t> data) noexcept;
// Thread: any. Pure.
[[nodiscard]] bool is_standard(const bus::UsbControlRequest& request) noexcept;

// What a device answers to a standard request (USB 2.0, 9.4) whatever it is: the data stage, whole;
// nothing: it stalls. `configuration`: the one that is chosen, 0 or 1, and changed here. Thread:
// any. Not RT.
[[nodiscard]] std::optional<DescriptorBytes> answer_standard(const UsbPersona& persona,
                                                             const bus::UsbControlRequest& request,
                                                             std::uint8_t& configuration);

// Whether a standard request ends the halt of an endpoint (USB 2.0, 9.1.1.5 and 9.4.5):
// CLEAR_FEATURE does that of one, choosing a setting those of its interface, choosing a
// configuration all. Thread: any. Pure.
[[nodiscard]] bool ends_halt(const bus::UsbControlRequest& request,
                             const bus::UsbEndpointInfo& endpoint) noexcept;

}  // namespace thimble::sim
