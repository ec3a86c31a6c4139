#include "daemon/coupling/placed_link.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace thimble::coupling {
namespace {

struct NotedLink final : ArmLink {
  void send(const HandSample& sample) noexcept override { sent = sample; }
  bool receive(ConstraintSet& out) noexcept override {
    if (!reply) return false;
    out = *reply;
    return true;
  }
  [[nodiscard]] LinkQuality quality() const noexcept override { return {.is_up = true}; }

  HandSample sent{};
  std::optional<ConstraintSet> reply{};
};

constexpr Displacement3 kPlace{-0.03, 0.5, 0.25};

TEST(PlacedLink, TellsTheWorldWhereTheArmStands) {
  NotedLink link;
  PlacedLink sut(link, kPlace);
  HandSample sample{.sequence = 7, .hand = {0.01, 0, 0}, .velocity = {0.2, 0, 0}};
  sample.impulse = {3, 0, 0};
  sut.send(sample);
  EXPECT_EQ(link.sent.hand, (Position3{0.01, 0, 0} + kPlace));
  EXPECT_EQ(link.sent.velocity, sample.velocity);
  EXPECT_EQ(link.sent.impulse, sample.impulse);
  EXPECT_EQ(link.sent.ghost, Position3{}) << "it has none";
  sample.has_ghost = true;
  sut.send(sample);
  EXPECT_EQ(link.sent.ghost, Position3{} + kPlace);
}

TEST(PlacedLink, TellsTheArmWhatIsWhereInItsOwnFrame) {
  NotedLink link;
  PlacedLink sut(link, kPlace);
  ConstraintSet out;
  EXPECT_FALSE(sut.receive(out));
  EXPECT_TRUE(sut.quality().is_up);

  link.reply.emplace();
  link.reply->planes.push_back({.normal = {-1, 0, 0}, .offset_m = 0.015});
  link.reply->planes.push_back({.normal = {0, 0.6, 0.8}, .offset_m = 0.5});
  link.reply->ghost = Position3{0.001, 0.002, 0.003} + kPlace;
  link.reply->has_ghost = true;
  link.reply->far.slave = Position3{0.1, 0, 0} + kPlace;
  link.reply->far.force = {1, 2, 3};
  link.reply->pressure = {-3, 2, 1};
  link.reply->has_pressure = true;
  link.reply->has_far = link.reply->has_near = link.reply->has_map = true;
  ASSERT_TRUE(sut.receive(out));
  // A place is as deep behind a plane as it is in the world.
  const Position3 tip{0.02, 0.03, 0.04};
  for (std::size_t i = 0; i < 2; ++i) {
    const ConstraintPlane& theirs = link.reply->planes[i];
    EXPECT_NEAR(dot(out.planes[i].normal, tip) - out.planes[i].offset_m,
                dot(theirs.normal, tip + kPlace) - theirs.offset_m, 1e-15);
  }
  EXPECT_NEAR(norm(out.ghost - Position3{0.001, 0.002, 0.003}), 0, 1e-15);
  EXPECT_NEAR(norm(out.far.slave - Position3{0.1, 0, 0}), 0, 1e-15);
  EXPECT_EQ(out.far.force, (Force3{1, 2, 3}));
  EXPECT_TRUE(out.has_pressure);
  EXPECT_EQ(out.pressure, (Force3{-3, 2, 1})) << "forces are the same in both";
  EXPECT_FALSE(out.has_near || out.has_map) << "cells have no other place than theirs";
}

}  // namespace
}  // namespace thimble::coupling
