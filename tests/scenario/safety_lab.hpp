#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/app/arm_commands.hpp"
#include "daemon/session/safety_session.hpp"
#include "sim/bus/sim_gpio.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble::test {

inline const std::vector<std::string> kPoking{"arm.hand.motion=poke", "arm.hand.reach_m=0.03"};
inline constexpr api::ClientId kPerson{7};

inline config::SafetyConfig safety_lines() {
  config::SafetyConfig out;
  out.chip = "bench";
  out.estop = {"0", "1"};
  out.deadman = "2";
  out.enable = "3";
  out.lamp = "4";
  return out;
}

// A session with its safety lines and a person at the command line.
struct SafetyLab {
  explicit SafetyLab(const std::vector<std::string>& overrides, const ClosedLoop::Setup& setup = {})
      : loop(overrides, setup) {}

  void tick() {
    safety.step(loop.arm().clock());
    loop.tick();
    commands.poll();
  }
  void run(
      double s, const std::function<void()>& each = [] {}) {
    for (const MonotonicTime end = loop.now() + from_seconds(s); loop.now() < end;) {
      tick();
      each();
    }
  }
  bool run_until(double s, const std::function<bool()>& condition) {
    for (const MonotonicTime end = loop.now() + from_seconds(s); loop.now() < end; tick()) {
      if (condition()) return true;
    }
    return condition();
  }
  // What every stop asks of whoever holds the deadman.
  void take_hold_anew() {
    chip.set_level(2, true);
    run(0.03);
    chip.set_level(2, false);
    run(0.02);
  }
  Result<api::Done> clear() {
    std::optional<Result<api::Done>> told;
    commands.clear_fault("right", {}, kPerson, [&](const Result<api::Done>& done) { told = done; });
    run_until(3, [&] { return told.has_value(); });
    return told.value_or(fail(Errc::System, "no answer at all"));
  }
  Result<api::Done> clear_and_hold() {
    take_hold_anew();
    return clear();
  }
  // Cleared, driven, and a wall that pushes.
  void start() {
    ASSERT_TRUE(clear_and_hold());
    ASSERT_TRUE(run_until(8, [&] { return is_pushed(); }));
  }
  bool is_pushed() { return loop.frame().is_in_contact && norm(loop.frame().force) > 0.2; }
  bool is_active() { return loop.frame().state == OperatingState::Active; }
  void press(bool is_pressed) {
    chip.set_level(0, is_pressed);
    chip.set_level(1, is_pressed);
  }

  ClosedLoop loop;
  sim::SimGpioChip chip{loop.arm().clock(), "bench", 8};
  sim::SimGpioChips chips{{&chip}};
  session::SafetySession safety{safety_lines(), loop.runtime(), chips, nullptr};
  app::Leases leases{{{"right", true}}};
  app::ArmCommands commands{loop.runtime(), leases, loop.arm().clock(), &safety};
};

}  // namespace thimble::test
