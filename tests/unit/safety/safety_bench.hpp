#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "daemon/safety/safety_chain.hpp"
#include "sim/bus/sim_gpio.hpp"
#include "sim/time/virtual_clock.hpp"

namespace thimble::safety {

// A chain on a simulated chip: two channels on lines 0 and 1, deadman on 2, enable on 3, lamp on 4;
// a closed contact is low. Everything is closed, and the deadman was not let go of yet.
struct SafetyBench {
  static constexpr Duration kStep = std::chrono::milliseconds(5);

  sim::VirtualClock clock{MonotonicTime{std::chrono::seconds(1)}};
  sim::SimGpioChip chip{clock, "bench", 8};
  SafetyChain chain{
      {.estop_channels = 2, .has_deadman = true, .has_enable = true, .has_lamp = true}};
  std::unique_ptr<bus::GpioLines> lines = open();
  bool is_servo_beating{true};
  int asked{0};

  std::unique_ptr<bus::GpioLines> open() {
    auto opened = chip.open({"bench", {"0", "1", "2"}, {"3", "4"}}, nullptr);
    return opened ? *std::move(opened) : nullptr;
  }
  const ChainStatus& step() {
    clock.run_for(kStep);
    chain.step(lines.get(), clock.now(), [this] {
      ++asked;
      return is_servo_beating;
    });
    return chain.status();
  }
  void run(Duration duration) {
    for (Duration run{}; run < duration; run += kStep) step();
  }
  void press(bool is_pressed) {
    chip.set_level(0, is_pressed);
    chip.set_level(1, is_pressed);
  }
  // The adapter, pulled out and plugged in.
  void replug() {
    chip.lose();
    run(kStep * 4);
    chip.restore();
    lines = open();
    chain.restart_lines();
  }
  void let_go(bool has_let_go) { chip.set_level(2, has_let_go); }
  void take_hold_anew() {
    let_go(true);
    run(kStep * 12);
    let_go(false);
    run(kStep * 8);
  }
  void expect_stopped(ChainTrouble cause) const {
    EXPECT_TRUE(chain.status().is_stopped);
    EXPECT_EQ(chain.status().cause, cause) << to_string(chain.status().cause);
    EXPECT_FALSE(chain.status().is_enable_beating);
  }
  // Edges of the enable line within so long.
  std::uint64_t beats_within(Duration duration) {
    const std::uint64_t before = chip.changes(3);
    run(duration);
    return chip.changes(3) - before;
  }
  // Healthy, the deadman taken, and cleared by a person.
  bool start() {
    take_hold_anew();
    return chain.reset();
  }
};

}  // namespace thimble::safety
