#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "daemon/world/io/nrrd_write.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/unit/world/volume_files.hpp"

// An arm that leans on a piece, in whole sessions: the pressure of its cells is told and shown, and
// nothing of what is felt comes of its being told.
namespace thimble {
namespace {

using test::ClosedLoop;

constexpr double kEach_newton_per_m = 400;

// As a link of which the carriage does not tell it.
class Untold final : public coupling::ArmLink {
 public:
  explicit Untold(coupling::ArmLink& below) : below_(below) {}
  void send(const coupling::HandSample& sample) noexcept override { below_.send(sample); }
  bool receive(coupling::ConstraintSet& out) noexcept override {
    if (!below_.receive(out)) return false;
    out.has_pressure = false;
    out.pressure = {};
    return true;
  }
  [[nodiscard]] coupling::LinkQuality quality() const noexcept override { return below_.quality(); }

 private:
  coupling::ArmLink& below_;
};

class PressureOfPieces : public world::VolumeFiles {
 protected:
  // A wall of 12 cells of the 32 along x, from 11 mm on.
  std::vector<std::string> overrides(const std::string& scheme) const {
    std::vector<std::uint8_t> layout(32 * 32);
    for (std::size_t i = 0; i < layout.size(); ++i) layout[i] = i % 32 >= 20 ? 7 : 0;
    const std::string file = write("wall.nrrd", world::nrrd_of_bytes({32, 32, 1}, layout));
    return {"arm.hand.motion=still",
            "arm.world=desk",
            "arm.coupling.scheme=" + scheme,
            "world.name=desk",
            "world.source=pieces",
            "world.pieces.layout=" + file,
            "world.pieces.pressure_newton_per_m=" + std::to_string(kEach_newton_per_m)};
  }
};

TEST_F(PressureOfPieces, IsShownWhereTheHandIsFeltAndIsTheForceThatTheArmMakes) {
  ClosedLoop sut(overrides("ghost-point"));
  sut.run_until_driven();
  sut.run(0.2);
  EXPECT_FALSE(sut.snapshot().felt.has_pressure);
  sut.sim_arm().backend().push_tip({4.5, 0, 0});
  sut.run(3);
  ASSERT_TRUE(sut.frame().is_in_contact);
  const coupling::FeltHand& felt = sut.snapshot().felt;
  ASSERT_TRUE(felt.has_pressure);
  EXPECT_LT(felt.pressure.x, -0.2);
  EXPECT_EQ(felt.pressure.y, 0);
  EXPECT_EQ(felt.pressure.z, 0);
  ASSERT_EQ(felt.planes.size(), 1U);
  EXPECT_EQ(felt.planes[0].surface.stiffness.newton_per_m, kEach_newton_per_m);
  EXPECT_NEAR(felt.pressure.x, sut.frame().force.x, 0.1 * norm(sut.frame().force));
  sut.sim_arm().backend().push_tip({-4.5, 0, 0});
  sut.run(2);
  EXPECT_FALSE(sut.snapshot().felt.has_pressure);
  EXPECT_EQ(sut.snapshot().faults, 0U);
}

TEST_F(PressureOfPieces, MakesNoForceByBeingTold) {
  for (const std::string scheme :
       {"ghost-point", "constraint-plane", "remote-force", "spring-damper", "wave"}) {
    SCOPED_TRACE(scheme);
    ClosedLoop::Setup untold;
    untold.wrap_link = [](coupling::ArmLink& below) { return std::make_unique<Untold>(below); };
    ClosedLoop with(overrides(scheme));
    ClosedLoop without(overrides(scheme), untold);
    int told = 0;
    int differing = 0;
    for (int i = 0; i < 3000; ++i) {
      if (i == 1500) with.sim_arm().backend().push_tip({3, 0, 0});
      if (i == 1500) without.sim_arm().backend().push_tip({3, 0, 0});
      with.tick();
      without.tick();
      if (with.snapshot().felt.has_pressure) ++told;
      EXPECT_FALSE(without.snapshot().felt.has_pressure);
      const bool is_same = with.frame().force == without.frame().force &&
                           with.frame().tip == without.frame().tip &&
                           with.frame().offset == without.frame().offset;
      if (!is_same) ++differing;
    }
    EXPECT_GT(told, 100);
    EXPECT_EQ(differing, 0);
  }
}

}  // namespace
}  // namespace thimble
