#pragma once

#include <cstdint>

#include "hal/base/geometry.hpp"
#include "hal/base/io_status.hpp"
#include "hal/base/time.hpp"
#include "hal/device/fault.hpp"
#include "hal/device/haptic_device.hpp"
#include "hal/device/operating_state.hpp"

namespace thimble::servo {

// Everything one tick knew and did: what the flight recorder keeps. Base frame of the arm.
struct ServoFrame {
  std::uint64_t tick{0};
  MonotonicTime now{};  // the loop's clock
  Duration lateness{};  // of the wake-up
  Duration sample_age{};
  Duration dt{};
  OperatingState state{OperatingState::Configured};
  CalibrationState calibration{CalibrationState::Unknown};
  IoStatus read_status{IoStatus::NoData};
  IoStatus write_status{IoStatus::NoData};
  FaultCode fault{FaultCode::None};
  Position3 tip{};
  Velocity3 velocity{};
  Displacement3 offset{};
  Force3 wish{};   // before the limiter
  Force3 force{};  // after it: what was sent
  double gain{0};
  double generated_energy_j{0};  // work done on the hand since activation
  double wished_energy_j{0};     // what the wishes would have done, since the coupling began anew
  std::uint32_t buttons{0};
  std::uint32_t contacts{0};  // since activation
  bool is_in_contact{false};
  bool is_limited{false};
  bool is_stale{false};
  bool is_frozen{false};
  bool is_fading{false};
};

}  // namespace thimble::servo
