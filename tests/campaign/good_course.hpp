#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "tests/campaign/invariant.hpp"

namespace thimble::campaign {

// An arm at 1 kHz as it should be, driven up to 1 N for 600 ms, then as a test spoils it.
class GoodCourse {
 public:
  using Maker = std::function<std::unique_ptr<Invariant>(const Bounds&)>;
  using Spoil = std::function<void(Observation&)>;

  explicit GoodCourse(const Maker& maker, double rise_newton_per_s = 1000) {
    Bounds bounds;
    bounds.servo.limiter.max_force_newton = 5;
    bounds.servo.limiter.max_rise_newton_per_s = rise_newton_per_s;
    bounds.servo.limiter.peak_current_a = {3, 3, 3};
    sut_ = maker(bounds);
    now.servo.frame.dt = std::chrono::milliseconds(1);
    now.servo.frame.calibration = CalibrationState::Ok;
    run(600);
  }

  // So many ticks more; `spoil` is called in each before it is judged.
  void run(int ticks, const Spoil& spoil = {}) {
    for (; ticks > 0; --ticks) {
      step();
      if (spoil) spoil(now);
      findings_.look_at(now.servo.frame);
      sut_->see(now, findings_);
    }
  }
  [[nodiscard]] Judged judged() const {
    Judged judged;
    sut_->tell(judged);
    return judged;
  }
  // Empty: nothing was broken.
  [[nodiscard]] std::string broken() const {
    return findings_.breach() ? findings_.breach()->rule : "";
  }
  void stop(OperatingState state, FaultCode code) {
    now.servo.frame.state = state;
    now.servo.frame.fault = code;
    now.servo.frame.force = {};
    now.servo.frame.gain = 0;
    if (code != FaultCode::None) ++now.servo.faults;
  }

  Observation now;

 private:
  void step() {
    servo::ServoFrame& frame = now.servo.frame;
    ++frame.tick;
    frame.now = frame.now + frame.dt;
    frame.read_status = IoStatus::Ok;
    frame.write_status = IoStatus::Ok;
    const bool is_driven = frame.fault == FaultCode::None;
    frame.state = is_driven ? OperatingState::Active : frame.state;
    frame.gain = is_driven ? std::min(1.0, frame.gain + 0.002) : 0;
    const double newton = is_driven ? std::min(1.0, frame.gain) : 0;
    frame.force = {newton, 0, 0};
    now.truth.motor_force = frame.force;
    now.truth.motor_current_a = {newton, 0, 0};
    now.wire.largest_a = now.truth.motor_current_a;
    ++now.wire.reports;
    now.wire.last_report = frame.now;
    if (newton > 0) now.wire.last_nonzero = frame.now;
    now.edits_ok_since = frame.now;
  }

  std::unique_ptr<Invariant> sut_;
  Findings findings_;
};

}  // namespace thimble::campaign
