#include "cli/command_reply.hpp"

#include <gtest/gtest.h>

#include "daemon/world/cam/automaton_file.hpp"
#include "tests/unit/cli/sample_status.hpp"

namespace thimble::cli {
namespace {

TEST(CommandReply, ReadsWhatTheDaemonSaysAndLetsNoControlBytesThrough) {
  const auto sut = parse_command_reply(
      "{\"arm\": \"right\", \"lease\": \"client\", \"lease_number\": 7, \"state\": \"active\", "
      "\"instruction\": \"a\\u001b[31m\"}",
      "right");
  ASSERT_TRUE(sut) << sut.error().message;
  EXPECT_EQ(sut->arm, "right");
  EXPECT_EQ(sut->lease, "client");
  EXPECT_EQ(sut->lease_number, 7U);
  EXPECT_EQ(sut->state, "active");
  EXPECT_EQ(sut->instruction, "a?[31m");
}

TEST(CommandReply, TakesNoAnswerForSuccessThatIsNotToTheCommand) {
  const std::string good =
      R"({"arm": "right", "lease": "none", "lease_number": 0, "state": "active", "instruction": ""})";
  ASSERT_TRUE(parse_command_reply(good, "right"));
  EXPECT_FALSE(parse_command_reply(good, "left"));
  for (const std::string key : {"arm", "lease\"", "lease_number", "state", "instruction"}) {
    std::string other = good;
    other.replace(good.find(key), 1, "X");
    const auto sut = parse_command_reply(other, "right");
    ASSERT_FALSE(sut) << other;
    EXPECT_EQ(sut.error().code, Errc::Malformed);
    EXPECT_EQ(sut.error().message,
              "the answer is not the daemon's: it does not tell of arm right with its lease and "
              "state");
  }
  for (
      const char* other :
      {"", "{}", "[]", "nonsense", R"({"arm": "right"})",
       R"({"arm": "right", "lease": 1, "lease_number": 1, "state": "", "instruction": ""})",
       R"({"arm": "right", "lease": "client", "lease_number": -1, "state": "", "instruction": ""})"}) {
    EXPECT_FALSE(parse_command_reply(other, "right")) << other;
  }
}

TEST(CommandReply, ALeaseStillStandsWhileItsOwnNumberIsAClients) {
  const CommandReply reply{"right", "client", 7, "active", ""};
  api::Status status = sample_status();
  api::ArmStatus& arm = status.arms.front();
  arm.lease = "client";
  arm.lease_number = 7;
  EXPECT_TRUE(still_stands(reply, status));
  arm.lease_number = 8;
  EXPECT_FALSE(still_stands(reply, status)) << "somebody else's, a moment later";
  arm.lease_number = 7;
  arm.name = "left";
  EXPECT_FALSE(still_stands(reply, status));
  arm.name = "right";
  arm.lease = "none";
  EXPECT_FALSE(still_stands(reply, status));
  status.arms.clear();
  EXPECT_FALSE(still_stands(reply, status));
}

TEST(ChangedCells, AreKnownOnlyFromAnAnswerThatTellsOfTheWorld) {
  const auto cells = [](const char* count) {
    return parse_changed_cells(
        std::string(R"({"world": "box", "edits": 1, "changed_cells": )") + count + "}", "box");
  };
  EXPECT_EQ(cells("0"), 0U);
  EXPECT_EQ(cells("7"), 7U);
  EXPECT_EQ(cells("18446744073709551615"), 18446744073709551615U);
  for (const char* other : {"-1", "1.5", "\"7\"", "null", "[7]"}) {
    EXPECT_FALSE(cells(other)) << other;
  }
  for (const char* other : {"", "{}", R"({"world": "box"})", R"({"changed_cells": 7})",
                            R"({"world": "x", "changed_cells": 7})"}) {
    const auto sut = parse_changed_cells(other, "box");
    ASSERT_FALSE(sut) << other;
    EXPECT_EQ(sut.error().message,
              "the answer is not the daemon's: it does not tell of the changed cells of world box");
  }
}

TEST(PieceReply, IsKnownOnlyFromAnAnswerThatTellsOfTheWorld) {
  const auto sut = parse_piece_reply(
      R"({"world": "desk", "outcome": "no\u001b room", "is_done": false})", "desk");
  ASSERT_TRUE(sut);
  EXPECT_FALSE(sut->is_done);
  EXPECT_EQ(sut->outcome.find('\x1b'), std::string::npos);
  EXPECT_TRUE(
      parse_piece_reply(R"({"world": "desk", "outcome": "selected", "is_done": true})", "desk")
          ->is_done);
  for (const char* other : {"", "{}", R"({"world": "desk", "outcome": "selected"})",
                            R"({"world": "x", "outcome": "selected", "is_done": true})",
                            R"({"world": "desk", "outcome": 1, "is_done": true})",
                            R"({"world": "desk", "outcome": "selected", "is_done": "true"})"}) {
    EXPECT_FALSE(parse_piece_reply(other, "desk")) << other;
  }
}

TEST(LoadedState, IsKnownOnlyFromAnAnswerThatTellsOfTheWorld) {
  EXPECT_TRUE(check_loaded_state(R"({"world": "dish", "steps": 70})", "dish"));
  for (const char* other :
       {"", "{}", "nonsense", R"({"world": "dish"})", R"({"steps": 70})",
        R"({"world": "x", "steps": 70})", R"({"world": "dish", "steps": -1})"}) {
    const auto sut = check_loaded_state(other, "dish");
    ASSERT_FALSE(sut) << other;
    EXPECT_EQ(sut.error().code, Errc::Malformed);
    EXPECT_EQ(sut.error().message,
              "the answer is not the daemon's: it does not tell of the steps of world dish");
  }
}

// Or a file that was good is replaced by what no world takes back.
TEST(SavedState, IsOneThatAWorldTakesBack) {
  const world::cam::AutomatonState state{"life", {3, 3, 0}, 7, std::vector<std::uint16_t>(64)};
  const std::string good = world::cam::to_nrrd(state);
  EXPECT_TRUE(check_saved_state(good, "dish"));
  for (const std::string& other : {std::string(), std::string("{}"), std::string("<html></html>"),
                                   good.substr(0, good.size() - 1)}) {
    const auto sut = check_saved_state(other, "dish");
    ASSERT_FALSE(sut) << other;
    EXPECT_EQ(sut.error().code, Errc::Malformed);
    EXPECT_EQ(sut.error().message,
              "the answer is not the daemon's: it does not tell of the state of world dish");
  }
}

TEST(CommandReply, SaysActiveOnlyOfAnArmThatIs) {
  EXPECT_EQ(render_reply("activate", {"right", "client", 7, "active", ""}),
            "arm right is active while this runs");
  EXPECT_EQ(render_reply("activate", {"right", "configuration", 0, "active", ""}),
            "arm right is kept active by the configuration");
  EXPECT_EQ(render_reply("activate", {"right", "client", 7, "calibrating", "press the button"}),
            "arm right is held while this runs, but not active yet (calibrating): press the "
            "button");
  EXPECT_EQ(render_reply("activate", {"right", "configuration", 0, "calibrating", "press"}),
            "arm right is held by the configuration, but not active yet (calibrating): press");
}

TEST(CommandReply, SaysHowTheArmStandsAfterAFault) {
  EXPECT_EQ(render_reply("clear-fault", {"right", "none", 0, "inactive", ""}),
            "arm right: the fault is cleared, the arm is inactive");
  EXPECT_EQ(render_reply("clear-fault", {"right", "none", 0, "calibrating", "press"}),
            "arm right: the fault is cleared, the arm is calibrating: press");
  EXPECT_EQ(render_reply("deactivate", {"right", "none", 0, "active", ""}),
            "arm right: deactivate done");
}

TEST(CommandReply, SaysThatAWorldWasAskedAndNotThatItIsDone) {
  EXPECT_EQ(render_reply("free", {"right", "configuration", 0, "active", ""}),
            "arm right: its world was asked to switch free motion");
  EXPECT_EQ(render_reply("reset", {"right", "configuration", 0, "active", ""}),
            "arm right: its world was asked for a reset");
}

}  // namespace
}  // namespace thimble::cli
