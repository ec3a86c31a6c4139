#include "tests/campaign/worlds.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/campaign/episode.hpp"
#include "tests/campaign/hostile_link.hpp"

namespace thimble::campaign {
namespace {

using std::chrono::milliseconds;

TEST(Worlds, AVolumeIsTheSameForTheSameSeedAndAnotherForAnother) {
  campaign::Setup setup;
  setup.world = "volume";
  setup.materials = 3;
  setup.cells = 8;
  const std::string volume = volume_of(setup);
  const std::string materials = more_configuration(setup);
  EXPECT_EQ(volume_of(setup), volume);
  EXPECT_EQ(more_configuration(setup), materials);
  ++setup.world_seed;
  EXPECT_NE(volume_of(setup), volume);
  EXPECT_NE(more_configuration(setup), materials);
  setup.world = "box";
  EXPECT_EQ(more_configuration(setup), "");
}

// One tick of each is enough to see that its configuration is taken.
TEST(Worlds, WhateverIsDrawnCanBePlayed) {
  Tally all;
  for (std::uint64_t episode = 0; episode < 150; ++episode) {
    Programme programme = draw(11, episode);
    programme.ticks = 1;
    const Ending ending = play(programme);
    ASSERT_FALSE(ending.breach.has_value()) << episode << ' ' << to_text(*ending.breach);
    all.add(ending.tally);
  }
  EXPECT_GT(all.in_spheres, 3U);
  EXPECT_GT(all.in_volumes, 3U);
  EXPECT_GT(all.with_bystander, 3U);
}

Programme busy(std::string_view world) {
  Programme programme;
  programme.seed = 3;
  programme.ticks = 15'000;
  programme.setup.world = world;
  programme.setup.cells = 5;
  programme.setup.hand_reach_m = 0.03;
  for (int ms = 3000; ms < 15'000; ms += 2000) {
    programme.events.push_back({EventKind::Unplug, milliseconds(ms), milliseconds(10)});
    programme.events.push_back({EventKind::Estop, milliseconds(ms + 500), milliseconds(10)});
    programme.events.push_back({EventKind::Clear, milliseconds(ms + 600)});
  }
  return programme;
}

TEST(Worlds, SpheresAndVolumesAreFeltAndBreakNoRule) {
  Programme sphere = busy("sphere");
  sphere.setup.hand_newton_per_m = 600;
  Programme volume = busy("volume");
  volume.setup.materials = 3;
  for (Programme& programme : std::array{sphere, volume}) {
    programme.events.clear();
    const Ending ending = play(programme);
    EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
    EXPECT_GT(ending.tally.contacts, 2U) << programme.setup.world;
  }
}

TEST(Worlds, AnotherArmGoesOnWhileTheFirstIsStoppedAndUnplugged) {
  Programme programme = busy("box");
  programme.setup.has_bystander = true;
  const Ending ending = play(programme);
  EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
  EXPECT_EQ(ending.tally.unplugged, 6U);
  EXPECT_NEAR(ending.tally.played_s, 30, 0.5) << "of both";
  EXPECT_EQ(play(programme).trace, ending.trace);
}

// What an arm half would get of a world that lies, and that it is the same each time.
TEST(HostileLink, SendsWhatNoWorldWould) {
  class Silent final : public coupling::ArmLink {
    void send(const coupling::HandSample&) noexcept override {}
    bool receive(coupling::ConstraintSet& out) noexcept override {
      out = {};
      return true;
    }
    [[nodiscard]] coupling::LinkQuality quality() const noexcept override { return {}; }
  };
  Silent below;
  HostileLink sut(below, 4);
  HostileLink again(below, 4);
  int not_finite = 0;
  int not_unit = 0;
  int sound = 0;
  for (int i = 0; i < 20'000; ++i) {
    coupling::ConstraintSet set;
    coupling::ConstraintSet same;
    ASSERT_TRUE(sut.receive(set));
    ASSERT_TRUE(again.receive(same));
    ASSERT_EQ(set.planes.size(), same.planes.size());
    for (const coupling::ConstraintPlane& plane : set.planes) {
      const double length = norm(plane.normal);
      if (!std::isfinite(length) || !std::isfinite(plane.offset_m)) ++not_finite;
      if (std::abs(length - 1) > 1e-3) ++not_unit;
      if (std::abs(length - 1) < 1e-9 && std::abs(plane.offset_m) < 0.1) ++sound;
    }
  }
  EXPECT_GT(sut.lies(), 4000U);
  EXPECT_GT(not_finite, 1000);
  EXPECT_GT(not_unit, 1000);
  EXPECT_GT(sound, 1000) << "some must be taken";
}

TEST(HostileLink, NeitherSchemeWishesForAForceOutOfBounds) {
  for (const bool is_thesis_literal : {false, true}) {
    Programme programme = busy("box");
    programme.events.clear();
    programme.setup.is_hostile = true;
    programme.setup.is_thesis_literal = is_thesis_literal;
    const Ending ending = play(programme);
    EXPECT_FALSE(ending.breach.has_value()) << to_text(*ending.breach);
    EXPECT_GT(ending.tally.lies, 100U);
  }
}

}  // namespace
}  // namespace thimble::campaign
