#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "daemon/app/arm_commands.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "tests/support/closed_loop.hpp"

// What is asked of an arm's world in the name of its hand, over whatever carries it.
namespace thimble {
namespace {

struct Asking {
  explicit Asking(const std::vector<std::string>& said) : loop(said) {}

  Result<api::Done> ask(const std::string& arm, api::HandVerb verb) {
    std::optional<Result<api::Done>> told;
    sut.ask_world(arm, verb, [&told](const Result<api::Done>& done) { told = done; });
    return told.value_or(fail(Errc::System, "not answered"));
  }
  const world::cam::PieceBoard& board() {
    return loop.runtime().worlds().front()->pieces()->board();
  }

  test::ClosedLoop loop;
  app::Leases leases{{{"right", true}}};
  app::ArmCommands sut{loop.runtime(), leases, loop.arm().clock()};
};

std::vector<std::string> among_pieces(const std::vector<std::string>& more) {
  std::vector<std::string> said{"arm.hand.motion=still", "arm.world=desk",
                                "world.name=desk",       "world.source=pieces",
                                "world.pieces.cells=32", "world.pieces.count=1"};
  said.insert(said.end(), more.begin(), more.end());
  return said;
}

TEST(AskWorld, FreesAndResetsPiecesAlsoOverALinkThatLosesDoublesAndReorders) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{},
        std::vector<std::string>{"arm.impairment.delay_s=0.05", "arm.impairment.loss=0.3",
                                 "arm.impairment.duplicate=0.2", "arm.impairment.reorder=0.3"}}) {
    Asking sut(among_pieces(more));
    sut.loop.run(2);
    for (const bool is_on : {true, false, true}) {
      const auto told = sut.ask("right", api::HandVerb::Free);
      ASSERT_TRUE(told) << told.error().message;
      EXPECT_EQ(told->state, "active");
      sut.loop.run(1);
      EXPECT_EQ(sut.board().state().is_free_motion, is_on);
    }
    ASSERT_TRUE(sut.ask("right", api::HandVerb::Reset));
    sut.loop.run(1);
    EXPECT_FALSE(sut.board().state().is_free_motion);
    EXPECT_EQ(sut.board().counters().actions, 4U) << "each was done once";
  }
}

TEST(AskWorld, NothingIsAskedAgainByAnArmThatIsActiveAgain) {
  Asking sut(among_pieces({}));
  sut.loop.run(2);
  ASSERT_TRUE(sut.ask("right", api::HandVerb::Free));
  sut.loop.run(1);
  for (const bool is_wanted : {false, true}) {
    sut.loop.arm().session().controls().want_active = is_wanted;
    sut.loop.run(3);
  }
  EXPECT_EQ(sut.board().counters().actions, 1U);
  EXPECT_TRUE(sut.board().state().is_free_motion);
  ASSERT_TRUE(sut.ask("right", api::HandVerb::Free));
  sut.loop.run(1);
  EXPECT_EQ(sut.board().counters().actions, 2U);
}

TEST(AskWorld, IsRefusedWhereTheHandIsInNoWorld) {
  Asking sut(among_pieces({"arm.activate=false"}));
  sut.loop.run(1);
  const auto told = sut.ask("right", api::HandVerb::Reset);
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().code, Errc::Busy);
  EXPECT_NE(told.error().message.find("is not active"), std::string::npos);
  EXPECT_EQ(sut.ask("left", api::HandVerb::Reset).error().code, Errc::NotFound);
}

TEST(AskWorld, IsRefusedWhereTheWorldDoesNothingOfTheKind) {
  Asking sut({"arm.hand.motion=still"});
  sut.loop.run(1);
  const auto told = sut.ask("right", api::HandVerb::Free);
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().code, Errc::Unsupported);
  EXPECT_NE(told.error().message.find("only a world of pieces"), std::string::npos);
}

}  // namespace
}  // namespace thimble
