#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "daemon/app/arm_commands.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

constexpr api::ClientId kHer{7};
constexpr api::ClientId kHim{8};

// Notes who was told, and the beginning of what.
api::FileAnswer hear(std::vector<std::string>& told, const std::string& who) {
  return [&told, who](const Result<std::string>& file) {
    told.push_back(who + (file ? file->substr(0, 4) : file.error().message));
  };
}

// Who has gone waits for nothing, so nobody shall wait for his edits.
TEST(WorldCommands, EditsOfAClientThatWentAreDroppedUnlessTheyHaveBegun) {
  test::ClosedLoop loop({"world.source=box:256", "arm.hand.motion=still"});
  app::Leases leases({{"right", false}});
  app::ArmCommands sut(loop.runtime(), leases, loop.arm().clock());
  const std::string world = loop.runtime().worlds().front()->name();
  const auto fill = [](std::uint8_t cell) {
    return api::CellEdit{api::CellEdit::Kind::Fill, {}, {255, 255, 255}, {}, 0, cell};
  };
  const auto unheard = [](const Result<api::Edited>&) { FAIL() << "told somebody who went"; };
  std::optional<Result<api::Edited>> told;
  sut.edit_world(world, {fill(1), fill(0)}, kHim, unheard);
  loop.tick();
  sut.edit_world(world, {fill(1), fill(1), fill(1)}, kHim, unheard);
  sut.edit_world(world, {fill(1)}, kHer, [&](const Result<api::Edited>& done) { told = done; });
  sut.client_gone(kHim);
  EXPECT_EQ(loop.runtime().worlds().front()->edits()->waiting(), 3U);
  loop.run_until(2, [&] {
    sut.poll();
    return told.has_value();
  });
  ASSERT_TRUE(told.has_value() && *told);
  EXPECT_EQ((*told)->changed_cells, 256U * 256 * 256) << "what had begun came to its end";
  EXPECT_EQ(loop.runtime().worlds().front()->edits()->applied(), 3U);
}

// One that is read whole takes the net plane's time: one in each look at the commands, in turn.
TEST(WorldCommands, WholeWorldsAreReadOneALookAndNotForWhoWent) {
  test::ClosedLoop loop({"world.source=box:16", "arm.hand.motion=still"});
  app::Leases leases({{"right", false}});
  app::ArmCommands sut(loop.runtime(), leases, loop.arm().clock());
  const std::string world = loop.runtime().worlds().front()->name();
  std::vector<std::string> told;
  sut.read_cells(world, kHer, hear(told, "her "));
  sut.read_cells(world, kHim, [](const auto&) { FAIL() << "told somebody who went"; });
  sut.save_world(world, kHer, hear(told, "saved "));
  sut.load_world(world, "no state", kHer, [&told](const Result<std::uint64_t>& steps) {
    told.push_back(steps ? "loaded" : "refused");
  });
  sut.save_world(world, kHim, [](const auto&) { FAIL() << "told somebody who went"; });
  sut.load_world(world, "", kHim, [](const auto&) { FAIL() << "done for somebody who went"; });
  sut.client_gone(kHim);
  EXPECT_TRUE(told.empty());
  sut.poll();
  ASSERT_EQ(told, std::vector<std::string>{"her NRRD"});
  sut.poll();
  ASSERT_EQ(told.size(), 2U);
  EXPECT_NE(told.back().find("saved world 'box'"), std::string::npos) << told.back();
  for (int i = 0; i < 4; ++i) sut.poll();
  EXPECT_EQ(told.size(), 3U);
  EXPECT_EQ(told.back(), "refused");
}

// Its board is looked at first, which takes it a while.
TEST(WorldCommands, PiecesAreLookedAtWhenItIsTheirTurnAndNotForWhoWentMeanwhile) {
  test::ClosedLoop loop({"world.source=pieces", "world.pieces.cells=32", "world.pieces.count=1",
                         "arm.hand.motion=still"});
  app::Leases leases({{"right", false}});
  app::ArmCommands sut(loop.runtime(), leases, loop.arm().clock());
  const std::string world = loop.runtime().worlds().front()->name();
  std::vector<std::string> told;
  sut.read_cells(world, kHim, hear(told, "his "));
  sut.read_cells(world, kHer, hear(told, "her "));
  sut.poll();
  sut.client_gone(kHim);
  loop.run_until(2, [&] {
    sut.poll();
    return !told.empty();
  });
  loop.run_until(0.5, [&] {
    sut.poll();
    return false;
  });
  EXPECT_EQ(told, std::vector<std::string>{"her NRRD"});
}

TEST(WorldCommands, AWorldThatIsNotThereIsRefusedAtOnce) {
  test::ClosedLoop loop({"world.source=box:16", "arm.hand.motion=still"});
  app::Leases leases({{"right", false}});
  app::ArmCommands sut(loop.runtime(), leases, loop.arm().clock());
  int refused = 0;
  const auto count = [&refused](const auto& answer) {
    refused += !answer && answer.error().code == Errc::NotFound ? 1 : 0;
  };
  sut.read_cells("nowhere", kHer, count);
  sut.save_world("nowhere", kHer, count);
  sut.load_world("nowhere", "", kHer, count);
  EXPECT_EQ(refused, 3);
}

}  // namespace
}  // namespace thimble
