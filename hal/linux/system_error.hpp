#pragma once

#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::linux {

// "WHAT: the system's word for CODE", an errno: Permission, NotFound and Busy where that is what it
// says, else System. Thread: any. Not RT.
[[nodiscard]] Error system_error(std::string_view what, int code);

}  // namespace thimble::linux
