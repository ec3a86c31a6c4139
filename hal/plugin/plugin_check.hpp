#pragma once

#include <cstddef>
#include <functional>

#include "hal/base/result.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/plugin/plugin_abi.h"
#include "hal/rt/annotations.hpp"

namespace thimble::plugin {

// What a descriptor's pointers are for.
enum class Access { Read, Execute };

// Whether so many bytes at an address belong to the shared object that is judged, all of them, and
// may be read, or executed.
using IsInObject = std::function<bool(const void* start, std::size_t bytes, Access access)>;

// Whether `plugin`, of which the object says that it has so many bytes, is what this host takes:
// magic, version, revision, sizes, names, and every function there and in the object. Reads nothing
// that is not in the object, calls nothing.
// Thread: any. Not RT. Errors: Unsupported for another version, else Malformed; the message is
// the second half of a sentence about the plugin.
[[nodiscard]] Result<void> check_plugin(const thimble_plugin& plugin, std::size_t bytes,
                                        const IsInObject& is_in_object);

// The driver of bare USB devices, if it has one; `plugin` has passed check_plugin().
[[nodiscard]] const thimble_usb_driver* usb_driver_of(const thimble_plugin& plugin) noexcept;

// Whether an arm may have these; the ranges stand in plugin_abi.h.
[[nodiscard]] Result<HapticCapabilities> read_capabilities(const thimble_capabilities& said);

// Whether every number of a sample is one that an arm can have. RT.
THIMBLE_RT [[nodiscard]] bool is_sound(const thimble_sample& sample) noexcept;

// Why these reports or frames cannot be, or nothing.
[[nodiscard]] Result<void> check_facts(const thimble_model_facts& facts);
[[nodiscard]] Result<void> check_report_bytes(std::size_t input, std::size_t output);

}  // namespace thimble::plugin
