#pragma once

#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::linux {

// All of `text`, to the last byte; `descriptor` stays open. 0, or the errno of what failed: a disk
// may tell only when it is closed. Thread: any. Not RT.
[[nodiscard]] int write_all(int descriptor, std::string_view text) noexcept;

// All of a file, made or replaced: what was there stays whole until the new one is there. It is
// written beside it, with its rights, and takes its name. In its place, where that would be
// something else: a device or a pipe, a link that leads nowhere, somebody else's file, one with
// more names, or one in a folder that takes no other file.
// Not forced onto the disk: a loss of power may leave the earlier one.
// Errors: System, the system's word. Thread: any. Not RT.
[[nodiscard]] Result<void> replace_file(const std::string& path, std::string_view text);

}  // namespace thimble::linux
