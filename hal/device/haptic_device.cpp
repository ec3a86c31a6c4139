#include "hal/device/haptic_device.hpp"

namespace thimble {

std::string_view to_string(CalibrationState state) noexcept {
  switch (state) {
    case CalibrationState::Unknown:
      return "unknown";
    case CalibrationState::NeedsUser:
      return "needs-user";
    case CalibrationState::Ok:
      return "ok";
  }
  return "unknown";
}

}  // namespace thimble
