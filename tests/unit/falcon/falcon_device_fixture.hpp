#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "drivers/falcon/falcon_device.hpp"
#include "drivers/falcon/find_model.hpp"
#include "tests/support/made_wrench.hpp"
#include "tests/unit/falcon/scripted_usb.hpp"

namespace thimble::falcon {

using Counts = std::array<std::int16_t, 3>;
using std::chrono::milliseconds;

inline constexpr Counts kSomewhere{100, -200, 300};
inline constexpr int kHomed = 0x70;

inline LimitedWrench wrench(double x, double y, double z) {
  return servo::WrenchLimiter::make({x, y, z});
}

// A device on a scripted bus, its arm played by the test: reply() is what the arm says next.
class FalconDeviceTest : public testing::Test {
 protected:
  FalconDeviceTest() { open(); }
  void open(std::vector<std::uint8_t> image = {}) {
    sut_.reset();
    script_ = {};
    sut_ = std::make_unique<FalconDevice>(
        std::make_unique<test::ScriptedUsb>(script_), model_,
        FalconDevice::Settings{model_.newton_per_count, std::move(image), clock_});
  }
  IoStatus read() { return sut_->read(state_); }
  IoStatus write(double x = 0, double y = 0, double z = 0) { return sut_->write(wrench(x, y, z)); }
  // A packet without data, one latency period later.
  IoStatus pass(Duration time = milliseconds(1)) {
    script_.arrive({}, time);
    return read();
  }
  // Nothing at all comes from the pipe.
  IoStatus pass_silently(Duration time = milliseconds(1)) {
    script_.now = script_.now + time;
    return read();
  }
  IoStatus reply(Counts counts, int flags = 0, Duration after = milliseconds(1)) {
    script_.arrive(test::report_bytes(counts, flags), after);
    return read();
  }
  // The firmware runs already and answers the knock.
  void boot() {
    const std::size_t settings = script_.requests.size() + 4;
    for (int i = 0; i < 20 && script_.requests.size() < settings; ++i) {
      write();
      pass();
    }
    write();
    reply({0, 0, 0});
    script_.submitted.clear();
  }
  void home(Counts counts = kSomewhere) {
    boot();
    for (int i = 0; i <= ArmReference::kHomedReports; ++i) {
      write();
      EXPECT_EQ(reply(counts, kHomed), IoStatus::Ok);
    }
    EXPECT_EQ(state_.calibration, CalibrationState::Ok);
    script_.submitted.clear();
  }
  // What the newest packet told the motors.
  [[nodiscard]] Counts sent() const {
    return test::reports_in(script_.submitted.back()).at(0).encoder_counts;
  }
  [[nodiscard]] int sent_flags() const { return script_.submitted.back().at(13) - 'A'; }
  [[nodiscard]] std::size_t packets() const { return script_.submitted.size(); }

  // That of the script.
  class ScriptClock final : public Clock {
   public:
    explicit ScriptClock(const test::UsbScript& script) : script_(script) {}
    [[nodiscard]] MonotonicTime now() const noexcept override { return script_.now; }
    Duration sleep_until(MonotonicTime /*deadline*/) noexcept override { return {}; }

   private:
    const test::UsbScript& script_;
  };

  const FalconModel& model_{*find_model("falcon")};
  test::UsbScript script_;
  ScriptClock script_clock_{script_};
  const Clock* clock_{nullptr};  // what open() gives the driver
  HapticState state_;
  std::unique_ptr<FalconDevice> sut_;
};

}  // namespace thimble::falcon
