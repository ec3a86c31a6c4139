#include "daemon/session/arm_instruction.hpp"

namespace thimble::session {

std::string instruction_for(ArmRig& rig) {
  const std::string trouble = rig.trouble();
  if (!trouble.empty()) return trouble + "; trying again";
  ArmSession& session = rig.session();
  if (session.snapshot().frame.state == OperatingState::Lost) {
    return session.config().device + " is gone: plug it in again, then calibrate it";
  }
  if (session.snapshot().frame.state == OperatingState::Fault) {
    return "see to what the fault says, then: thimble clear-fault " + session.config().name;
  }
  return std::string(session.device().calibration_instruction());
}

}  // namespace thimble::session
