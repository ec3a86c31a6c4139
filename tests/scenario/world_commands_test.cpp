#include <gtest/gtest.h>

#include <optional>

#include "daemon/app/arm_commands.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

constexpr api::ClientId kHer{7};
constexpr api::ClientId kHim{8};

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

}  // namespace
}  // namespace thimble
