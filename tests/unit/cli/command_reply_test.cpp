#include "cli/command_reply.hpp"

#include <gtest/gtest.h>

namespace thimble::cli {
namespace {

TEST(CommandReply, ReadsWhatTheDaemonSaysAndLetsNoControlBytesThrough) {
  const CommandReply sut = parse_command_reply(
      "{\"arm\": \"right\", \"lease\": \"client\", \"state\": \"active\", "
      "\"instruction\": \"a\\u001b[31m\"}");
  EXPECT_EQ(sut.arm, "right");
  EXPECT_EQ(sut.lease, "client");
  EXPECT_EQ(sut.state, "active");
  EXPECT_EQ(sut.instruction, "a?[31m");
  EXPECT_EQ(parse_command_reply("nonsense").arm, "");
}

TEST(CommandReply, SaysActiveOnlyOfAnArmThatIs) {
  EXPECT_EQ(render_reply("activate", {"right", "client", "active", ""}),
            "arm right is active while this runs");
  EXPECT_EQ(render_reply("activate", {"right", "configuration", "active", ""}),
            "arm right is kept active by the configuration");
  EXPECT_EQ(render_reply("activate", {"right", "client", "calibrating", "press the button"}),
            "arm right is held while this runs, but not active yet (calibrating): press the "
            "button");
  EXPECT_EQ(render_reply("activate", {"right", "configuration", "calibrating", "press"}),
            "arm right is held by the configuration, but not active yet (calibrating): press");
}

TEST(CommandReply, SaysHowTheArmStandsAfterAFault) {
  EXPECT_EQ(render_reply("clear-fault", {"right", "none", "inactive", ""}),
            "arm right: the fault is cleared, the arm is inactive");
  EXPECT_EQ(render_reply("clear-fault", {"right", "none", "calibrating", "press"}),
            "arm right: the fault is cleared, the arm is calibrating: press");
  EXPECT_EQ(render_reply("deactivate", {"right", "none", "active", ""}),
            "arm right: deactivate done");
}

}  // namespace
}  // namespace thimble::cli
