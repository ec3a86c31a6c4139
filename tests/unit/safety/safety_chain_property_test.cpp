// Random programs of buttons, wires, chips and people against a plain account of what they mean.
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <random>

#include "tests/unit/safety/safety_bench.hpp"

namespace thimble::safety {
namespace {

using std::chrono::milliseconds;

// What happened on the wires since the last step, and what follows from it.
struct Account {
  std::array<bool, 3> is_open{};        // now: channel, channel, deadman
  std::array<bool, 3> was_ever_open{};  // since the last step
  bool has_chip{true};
  std::optional<MonotonicTime> differ_since;
  bool is_defect{false};
  bool is_stopped{true};
  bool is_healthy{false};
  bool is_held{false};
  int open_readings{0};    // in a row, since the newest stop, of a chip that is there
  bool has_let_go{false};  // two of them

  void set(std::size_t wire, bool open) {
    is_open.at(wire) = open;
    was_ever_open.at(wire) = was_ever_open.at(wire) || open;
  }
  void step(MonotonicTime now) {
    open_readings = has_chip && is_open[2] ? open_readings + 1 : 0;
    has_let_go = has_chip && (has_let_go || open_readings >= 2);
    is_held = has_chip && !was_ever_open[2] && has_let_go;
    is_healthy = has_chip;
    if (has_chip) {
      const bool differ = is_open[0] != is_open[1];  // as they are read
      if (!differ) differ_since.reset();
      if (differ && !differ_since) differ_since = now;
      if (differ && now - *differ_since > milliseconds(50)) is_defect = true;
      if (is_open[0] && is_open[1]) is_defect = false;
      is_healthy = !was_ever_open[0] && !was_ever_open[1] && !is_defect;
    }
    if (!is_healthy && !is_stopped) {
      has_let_go = is_held = false;
      open_readings = 0;
    }
    if (!is_healthy) is_stopped = true;
    was_ever_open = is_open;
  }
  void reset() {
    if (is_healthy) is_stopped = false;
  }
};

class SafetyChainProgram : public testing::TestWithParam<unsigned>, protected SafetyBench {
 protected:
  void move_wire(std::size_t wire, bool is_open) {
    chip.set_level(wire, is_open);
    account_.set(wire, is_open);
  }
  void pull_or_plug() {
    if (account_.has_chip) {
      chip.lose();
    } else {
      chip.restore();
      lines = open();
      chain.restart_lines();
      account_.was_ever_open = account_.is_open;  // what was before is not told
    }
    account_.has_chip = !account_.has_chip;
  }
  void act(std::mt19937& dice) {
    const auto roll = dice() % 100;
    if (roll < 3) {  // somebody presses, or lets go, and contacts move one by one
      const bool is_open = !account_.is_open[0];
      move_wire(0, is_open);
      if (dice() % 4 != 0) move_wire(1, is_open);
    } else if (roll < 5) {  // a wire breaks, or is mended
      const std::size_t wire = dice() % 3;
      move_wire(wire, !account_.is_open.at(wire));
    } else if (roll < 6) {  // a pulse
      const std::size_t wire = dice() % 3;
      move_wire(wire, true);
      move_wire(wire, false);
    } else if (roll < 7) {
      pull_or_plug();
    } else if (roll < 15) {  // both ways of the button, whatever was
      move_wire(0, true);
      move_wire(1, true);
    } else if (roll < 35) {
      move_wire(0, false);
      move_wire(1, false);
    } else if (roll < 45) {  // a hand lets go, or takes hold
      move_wire(2, !account_.is_open[2]);
    }
  }
  Account account_;
};

TEST_P(SafetyChainProgram, IsStoppedAndHeldExactlyAsTheAccountSays) {
  std::mt19937 dice(GetParam());
  int free_steps = 0;
  int driven_steps = 0;
  int refused_steps = 0;
  for (int i = 0; i < 3000; ++i) {
    act(dice);
    step();
    account_.step(clock.now());
    ASSERT_EQ(chain.status().is_stopped, account_.is_stopped) << "step " << i;
    ASSERT_EQ(chain.status().is_deadman_held, account_.is_held) << "step " << i;
    const bool is_closed = account_.has_chip && !account_.is_open[2];
    ASSERT_FALSE(chain.status().must_release_deadman && (!is_closed || account_.has_let_go)) << i;
    if (dice() % 4 == 0) {
      account_.reset();
      ASSERT_EQ(chain.reset(), !account_.is_stopped) << "step " << i;
    }
    free_steps += chain.status().is_stopped ? 0 : 1;
    driven_steps += !chain.status().is_stopped && account_.is_held ? 1 : 0;
    refused_steps += chain.status().must_release_deadman ? 1 : 0;
  }
  EXPECT_GT(free_steps, 100) << "the program tries something";
  EXPECT_GT(driven_steps, 20);
  EXPECT_GT(refused_steps, 20);
  EXPECT_GT(chain.status().stops, 10U);
}

TEST_P(SafetyChainProgram, EnableRisesOnlyWhileAllIsWellAndStaysUpNeverLong) {
  std::mt19937 dice(GetParam());
  std::uint64_t changes = 0;
  MonotonicTime last{};
  int high_steps = 0;
  for (int i = 0; i < 3000; ++i) {
    act(dice);
    is_servo_beating = dice() % 20 != 0;
    const bool was_stopped = chain.status().is_stopped;
    step();
    if (chip.changes(3) != changes && chip.level(3)) {
      ASSERT_FALSE(was_stopped || chain.status().is_stopped) << "step " << i;
      ASSERT_TRUE(is_servo_beating);
      ASSERT_GE(clock.now() - last, milliseconds(20));
      last = clock.now();
    }
    changes = chip.changes(3);
    high_steps = chip.level(3) ? high_steps + 1 : 0;
    ASSERT_LT(high_steps, 60) << "as long as dice let the servo rest";
    if (dice() % 4 == 0) chain.reset();
  }
  EXPECT_GT(changes, 50U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SafetyChainProgram, testing::Range(1U, 41U));

}  // namespace
}  // namespace thimble::safety
