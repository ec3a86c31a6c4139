#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "daemon/app/piece_actions.hpp"
#include "daemon/app/whole_worlds.hpp"
#include "daemon/world/cam/piece_world.hpp"
#include "tests/support/closed_loop.hpp"

// What clients want done to the pieces on a board that is away, or does not come to it.
namespace thimble {
namespace {

using testing::HasSubstr;

class PieceCommands : public testing::Test {
 protected:
  using Told = std::optional<Result<api::PieceDone>>;

  void SetUp() override {
    loop_.run(2);
    ASSERT_TRUE(pieces().board().is_ready());
  }
  world::cam::PieceWorld& pieces() { return *loop_.runtime().worlds().front()->pieces(); }
  void ask(api::PieceVerb verb, Told& told) {
    sut_.submit("desk", verb, {7}, [&told](const Result<api::PieceDone>& done) {
      EXPECT_FALSE(told.has_value()) << "answered twice";
      told = done;
    });
  }

  test::ClosedLoop loop_{{"arm.hand.motion=still", "arm.activate=false", "arm.world=desk",
                          "world.name=desk", "world.source=pieces", "world.pieces.cells=32",
                          "world.pieces.count=1", "world.pieces.board=sim-usb"}};
  sim::VirtualClock clients_clock_;
  app::PieceActions sut_{loop_.runtime(), clients_clock_};
};

TEST_F(PieceCommands, OfABoardThatIsAwayAreRefusedAtOnceAndTheReasonIsSaid) {
  loop_.runtime().worlds().front()->usb_board()->unplug();
  Told begun;
  ask(api::PieceVerb::Free, begun);
  loop_.run(0.1);
  sut_.poll();
  ASSERT_TRUE(begun && *begun);
  EXPECT_FALSE((*begun)->is_done);
  EXPECT_THAT((*begun)->outcome, HasSubstr("failed meanwhile: "));
  ASSERT_TRUE(pieces().board().trouble());
  Told told;
  ask(api::PieceVerb::Free, told);
  sut_.poll();
  ASSERT_TRUE(told && *told);
  EXPECT_FALSE((*told)->is_done);
  EXPECT_THAT((*told)->outcome, HasSubstr("so nothing was done: "));
  loop_.runtime().worlds().front()->usb_board()->replug();
  loop_.run(2);
  ASSERT_TRUE(pieces().board().is_ready());
  EXPECT_FALSE(pieces().board().state().is_free_motion);
}

TEST_F(PieceCommands, ThatWereNotBegunInTimeAreNotDoneLater) {
  Told told;
  ask(api::PieceVerb::Free, told);
  clients_clock_.run_for(app::PieceActions::kPatience);
  sut_.poll();
  ASSERT_TRUE(told);
  ASSERT_FALSE(*told);
  EXPECT_EQ(told->error().code, Errc::Timeout);
  EXPECT_THAT(told->error().message, HasSubstr("it is not done"));
  loop_.run(1);
  EXPECT_FALSE(pieces().board().state().is_free_motion);
  EXPECT_EQ(pieces().board().counters().actions, 0U);
}

// Who asks for the cells and hangs up, again and again, neither fills the board's places nor has it
// look for him.
TEST_F(PieceCommands, LooksOfClientsWhoAreGoneAreNotWaitedForByOthers) {
  app::WholeWorlds whole(loop_.runtime(), sut_, clients_clock_);
  const auto nobody = [](const Result<std::string>&) { ADD_FAILURE() << "he is gone"; };
  for (std::uint64_t i = 0; i < 200; ++i) {
    whole.read_cells("desk", {100 + i}, nobody);
    whole.poll();
    whole.client_gone({100 + i});
    sut_.client_gone({100 + i});
  }
  std::optional<Result<std::string>> cells;
  whole.read_cells("desk", {7}, [&](const Result<std::string>& told) { cells = told; });
  Told told;
  ask(api::PieceVerb::Free, told);
  loop_.run_until(2, [&] {
    clients_clock_.run_for(std::chrono::milliseconds(1));
    sut_.poll();
    whole.poll();
    return cells && told;
  });
  ASSERT_TRUE(told && *told);
  EXPECT_TRUE((*told)->is_done);
  ASSERT_TRUE(cells && *cells) << "one is answered who stays";
  EXPECT_EQ(pieces().board().counters().actions, 2U) << "that look, and what was asked for";
}

TEST_F(PieceCommands, LooksAreOneAfterTheOther) {
  app::WholeWorlds whole(loop_.runtime(), sut_, clients_clock_);
  int answers = 0;
  for (std::uint64_t i = 0; i < 3; ++i) {
    whole.read_cells("desk", {10 + i}, [&](const Result<std::string>& told) {
      EXPECT_TRUE(told);
      ++answers;
    });
  }
  for (int polls = 0; polls < 20; ++polls) whole.poll();
  Told told;
  ask(api::PieceVerb::Free, told);
  int answers_before = -1;
  loop_.run_until(3, [&] {
    clients_clock_.run_for(std::chrono::milliseconds(1));
    sut_.poll();
    if (told && answers_before < 0) answers_before = answers;
    whole.poll();
    return answers == 3;
  });
  EXPECT_EQ(answers, 3);
  EXPECT_EQ(answers_before, 1) << "one look alone was before it";
}

}  // namespace
}  // namespace thimble
