#include "hal/device/fault.hpp"

namespace thimble {

std::string_view to_string(FaultCode code) noexcept {
  switch (code) {
    case FaultCode::None:
      return "none";
    case FaultCode::NonFiniteForce:
      return "non-finite-force";
    case FaultCode::NonFiniteState:
      return "non-finite-state";
    case FaultCode::Overspeed:
      return "overspeed";
    case FaultCode::StaleSample:
      return "stale-sample";
    case FaultCode::MissedExchanges:
      return "missed-exchanges";
    case FaultCode::Disconnected:
      return "disconnected";
    case FaultCode::ServoLate:
      return "servo-late";
    case FaultCode::Estop:
      return "estop";
    case FaultCode::LostReference:
      return "lost-reference";
    case FaultCode::GuardLost:
      return "guard-lost";
    case FaultCode::CommandTimeout:
      return "command-timeout";
  }
  return "unknown";
}

std::string_view explain(FaultCode code) noexcept {
  switch (code) {
    case FaultCode::None:
      return "no fault";
    case FaultCode::NonFiniteForce:
      return "the world asked for a force that is not a number; this is a defect, please report "
             "it with the flight recording";
    case FaultCode::NonFiniteState:
      return "the driver reported a position that is not a number; this is a defect, please "
             "report it with the flight recording";
    case FaultCode::Overspeed:
      return "the tip moved faster than the limit; hold the arm still, then clear the fault";
    case FaultCode::StaleSample:
      return "the arm stopped reporting its position; check its cable and power, then clear the "
             "fault";
    case FaultCode::MissedExchanges:
      return "too many exchanges with the arm were missed; check the cable and the load of this "
             "machine, then clear the fault";
    case FaultCode::Disconnected:
      return "the arm was unplugged; plug it in again and calibrate it; "
             "if it was driven, clear the fault then";
    case FaultCode::ServoLate:
      return "the servo did not run in time; reduce the load of this machine or grant real-time "
             "rights, then clear the fault";
    case FaultCode::Estop:
      return "the emergency stop is pressed, or the safety lines are not in order; see to it, then "
             "clear the fault";
    case FaultCode::LostReference:
      return "the arm lost its calibration while it was driven; clear the fault and calibrate it";
    case FaultCode::GuardLost:
      return "the guard of this arm ended while it was driven; another is started, then clear the "
             "fault";
    case FaultCode::CommandTimeout:
      return "the arm took no command for too long; check its cable and power, then clear the "
             "fault";
  }
  return "unknown fault";
}

bool FaultLatch::latch(FaultCode code, MonotonicTime at, std::uint64_t tick) noexcept {
  if (is_latched() || code == FaultCode::None) return false;
  fault_ = {code, at, tick, ++latched_};
  code_.store(code, std::memory_order_relaxed);
  return true;
}

ClearOutcome FaultLatch::clear(std::uint32_t number, bool inputs_healthy) noexcept {
  if (!is_latched() || number != fault_.number) return ClearOutcome::NotLatched;
  if (!inputs_healthy) return ClearOutcome::InputUnhealthy;
  fault_ = {};
  code_.store(FaultCode::None, std::memory_order_relaxed);
  return ClearOutcome::Cleared;
}

}  // namespace thimble
