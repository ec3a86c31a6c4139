#include "daemon/session/arm_instruction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace thimble::session {
namespace {

constexpr double kRounding_mm = 1e-6;
constexpr double kMost_m = 1e3;  // of a position that is none, as good as any
constexpr std::array<std::string_view, 3> kBack{"left", "down", "farther"};
constexpr std::array<std::string_view, 3> kForth{"right", "up", "nearer"};

}  // namespace

bool will_be_forgotten(const HapticCapabilities& can, const servo::ServoFrame& frame) noexcept {
  return frame.state == OperatingState::Fault && frame.calibration == CalibrationState::Ok &&
         can.device_watchdog > Duration::zero() && frame.sample_age > can.device_watchdog;
}

std::string instruction_for(ArmRig& rig) {
  const std::string trouble = rig.trouble();
  if (!trouble.empty()) return trouble + "; trying again";
  ArmSession& session = rig.session();
  const servo::ServoSnapshot& seen = session.snapshot();
  const std::string& name = session.config().name;
  if (seen.frame.state == OperatingState::Lost) {
    return session.config().device + " is gone: plug it in again, then calibrate it";
  }
  const bool is_fault = seen.frame.state == OperatingState::Fault;
  if (is_fault && seen.was_pulled && seen.is_place_known) {
    return "it is calibrated again; to go on: thimble clear-fault " + name;
  }
  // Calibrated, it has spoken; whatever it waits for, the next thing that it says brings it on.
  const bool waits_for_report =
      seen.frame.state == OperatingState::Configured || (is_fault && seen.was_pulled);
  if (waits_for_report && seen.frame.calibration == CalibrationState::Ok) {
    return "it does not report its position; check its power and cable";
  }
  if (is_fault) {
    const bool is_forgotten = will_be_forgotten(session.device().capabilities(), seen.frame);
    return "see to what the fault says, then: thimble clear-fault " + name +
           (is_forgotten ? ", and calibrate it" : "");
  }
  return std::string(session.device().calibration_instruction());
}

std::string way_in(ArmRig& rig) {
  ArmSession& session = rig.session();
  const servo::ServoSnapshot& seen = session.snapshot();
  const OperatingState state = seen.frame.state;
  if (state != OperatingState::Inactive && state != OperatingState::Active) return "";
  const servo::EntryBox& entry = session.loop().settings().entry;
  // Where it waits there is no offset: the ghost begins at the finger.
  if (seen.is_kept_out) return way_into(entry, seen.frame.tip);
  return way_into(entry, seen.frame.tip + seen.frame.offset);
}

std::string way_into(const servo::EntryBox& entry, Position3 finger) {
  const Displacement3 from_center = finger - entry.center;
  const std::array<double, 3> at_m{from_center.x, from_center.y, from_center.z};
  std::string way;
  bool is_far = false;
  for (std::size_t i = 0; i < at_m.size(); ++i) {
    const double outside_m = std::abs(at_m.at(i)) - entry.half_m.at(i);
    if (!(entry.half_m.at(i) > 0 && outside_m > 0) || !std::isfinite(outside_m)) continue;
    is_far = is_far || outside_m > servo::EntryBox::kLean_m;
    // Rounded up: who follows it is inside.
    way +=
        (way.empty() ? "" : ", ") +
        std::to_string(std::llround(std::ceil(std::min(outside_m, kMost_m) * 1e3 - kRounding_mm))) +
        " mm " + std::string((at_m.at(i) > 0 ? kBack : kForth).at(i));
  }
  return is_far ? "bring the arm into its world: " + way : "";
}

}  // namespace thimble::session
