#include <gtest/gtest.h>

#include "daemon/link/in_process_link.hpp"
#include "tests/unit/link/thimble_table.hpp"

// What a world says of its pressure, over each carriage that can say it; along a serial line and
// through sockets: serial_line_test.cpp, udp_thimble_test.cpp.
namespace thimble::link {
namespace {

using on_table::Arm;
using on_table::keyed_arm;
using on_table::keyed_world;
using on_table::Table;
using std::chrono::milliseconds;

constexpr Force3 kPressure{-0.1, 0, 1.0 / 3};

TEST(Pressure, IsCarriedToTheArmByOurDatagramsAndNoneOfAWorldThatKnowsNone) {
  for (const bool has_key : {false, true}) {
    Table table(has_key ? keyed_world() : ThimbleWorldEnd::Settings());
    Arm& arm = table.add_arm(has_key ? keyed_arm() : ThimbleArmEnd::Settings());
    table.run(50);
    ASSERT_FALSE(arm.replies.empty());
    EXPECT_FALSE(arm.replies.back().has_pressure);
    table.worlds.back()->pressure = kPressure;
    table.run(10);
    ASSERT_TRUE(arm.replies.back().has_pressure);
    EXPECT_EQ(arm.replies.back().pressure, kPressure);
    table.worlds.back()->pressure.reset();
    table.run(10);
    EXPECT_FALSE(arm.replies.back().has_pressure);
  }
}

TEST(Pressure, IsCarriedWithinOneProgram) {
  WorldDouble world;
  InProcessLink sut({}, world);
  coupling::ConstraintSet reply;
  for (const bool is_known : {false, true, false}) {
    SCOPED_TRACE(is_known);
    if (is_known) {
      world.pressure = kPressure;
    } else {
      world.pressure.reset();
    }
    bool has_answered = false;
    for (int i = 0; i < 5; ++i) {
      const std::uint64_t sequence = world.replies + 1;
      const MonotonicTime now{milliseconds(sequence)};
      sut.arm_end().send({.sequence = sequence, .sampled_at = now, .hand = {0.001, 0, 0}});
      (void)sut.pump(now);
      has_answered = sut.arm_end().receive(reply) || has_answered;
    }
    EXPECT_TRUE(has_answered);
    EXPECT_EQ(reply.has_pressure, is_known);
    EXPECT_EQ(reply.pressure, is_known ? kPressure : Force3());
  }
}

}  // namespace
}  // namespace thimble::link
