#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {
namespace {

// First fault latches and stays, whatever follows, until a request that names it is granted
// while the inputs are healthy; nothing else ends it, and state and fault say the same.
class Latch final : public Invariant {
 public:
  explicit Latch(const Bounds& /*bounds*/) {}

  void see(const Observation& now, Findings& findings) override {
    const servo::ServoSnapshot& servo = now.servo;
    const servo::ServoFrame& frame = servo.frame;
    const bool is_latched = frame.fault != FaultCode::None;
    const bool is_answered = servo.clear_answered != answered_;
    const bool is_cleared = is_answered && servo.clear_outcome == ClearOutcome::Cleared;
    const bool was_latched = fault_ != FaultCode::None;
    answered_ = servo.clear_answered;

    if (was_latched && !is_cleared) {
      findings.require("the first fault stays latched until it is cleared", frame.fault == fault_);
    }
    const bool is_new = is_latched && (!was_latched || is_cleared);
    if (is_new) ++faults_;
    // What a world says is refused before it is a force; so this would be a defect of ours.
    findings.require("no force is wished for that is not finite",
                     frame.fault != FaultCode::NonFiniteForce);
    findings.require("every latched fault is counted once", servo.faults == faults_);
    if (is_cleared) see_clear(now, was_latched, findings);
    findings.require("a fault means Fault or Lost",
                     !is_latched || is_stopped(frame.state) || is_coming_back(frame.state));
    note_pull(frame.state, is_latched);
    findings.require("an arm that is lost while it is driven latches",
                     !was_active_ || frame.state != OperatingState::Lost || is_latched);
    was_active_ = frame.state == OperatingState::Active;
    findings.require("Fault means a fault", frame.state != OperatingState::Fault || is_latched);
    // An arm that returns in this very tick gives no force yet: the next tick stops it.
    findings.require("an open e-stop stops in the tick that sees it",
                     now.is_estop_healthy || is_stopped(frame.state) || was_lost_);
    was_lost_ = frame.state == OperatingState::Lost;
    findings.require("a request to clear is answered in the next tick",
                     servo.clear_answered == now.clear_asked);
    fault_ = frame.fault;
  }

 private:
  static bool is_stopped(OperatingState state) noexcept {
    return state == OperatingState::Fault || state == OperatingState::Lost;
  }
  // One that was pulled after it was driven is cleared last: it is calibrated before.
  [[nodiscard]] bool is_coming_back(OperatingState state) const noexcept {
    return is_pulled_ &&
           (state == OperatingState::Configured || state == OperatingState::Calibrating);
  }
  void note_pull(OperatingState state, bool is_latched) noexcept {
    if (state == OperatingState::Lost) {
      is_pulled_ = is_pulled_ || (was_driven_ && is_latched);
      was_driven_ = false;
    }
    was_driven_ = was_driven_ || state == OperatingState::Active;
  }
  void see_clear(const Observation& now, bool was_latched, Findings& findings) {
    findings.require("an arm that was pulled is calibrated before it is cleared",
                     !is_pulled_ || now.servo.frame.calibration == CalibrationState::Ok);
    is_pulled_ = false;
    findings.require("only a latched fault is cleared", was_latched);
    findings.require("no fault is cleared by a request for another one", !now.is_clear_for_other);
    findings.require("no fault is cleared while an input is not healthy", now.is_estop_healthy);
  }

  FaultCode fault_{FaultCode::None};
  std::uint64_t faults_{0};
  std::uint32_t answered_{0};
  bool was_lost_{false};
  bool was_active_{false};
  bool was_driven_{false};  // since the arm came
  bool is_pulled_{false};   // after that, and not cleared since
};

}  // namespace

std::unique_ptr<Invariant> make_latch(const Bounds& bounds) {
  return std::make_unique<Latch>(bounds);
}

}  // namespace thimble::campaign
