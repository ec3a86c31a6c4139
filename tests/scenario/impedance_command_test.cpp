#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "daemon/app/arm_commands.hpp"
#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

// An arm in a session, and who tunes it.
struct Tuned {
  explicit Tuned(const std::vector<std::string>& said) : loop(said) {}

  Result<api::Done> tune(const std::string& arm, double newton_s_per_m) {
    std::optional<Result<api::Done>> told;
    sut.set_impedance(arm, newton_s_per_m, [&told](const Result<api::Done>& done) { told = done; });
    return told.value_or(fail(Errc::System, "not answered"));
  }
  // How hard it is at most while a hand pokes for so long.
  double hardest_newton(double s) {
    double hardest = 0;
    loop.run(s, [&] { hardest = std::max(hardest, norm(loop.frame().force)); });
    return hardest;
  }

  test::ClosedLoop loop;
  app::Leases leases{{{"right", true}}};
  app::ArmCommands sut{loop.runtime(), leases, loop.arm().clock()};
};

std::vector<std::string> poking(const std::string& more) {
  return {"arm.hand.motion=poke", "arm.hand.reach_m=0.025", "arm.impairment.delay_s=0.1", more};
}

TEST(ImpedanceCommand, MakesADrillOfASpongeInARunningSession) {
  for (const char* guard : {"arm.coupling.passivity=false", "arm.coupling.passivity=true"}) {
    auto said = poking("arm.coupling.scheme=wave");
    said.insert(said.end(), {"arm.coupling.impedance_newton_s_per_m=1", guard});
    Tuned sut(said);
    sut.loop.run(2);
    const double soft = sut.hardest_newton(6);
    const auto told = sut.tune("right", 30);
    ASSERT_TRUE(told) << told.error().message;
    EXPECT_EQ(told->state, "active");
    sut.loop.run(2);
    const double hard = sut.hardest_newton(6);
    EXPECT_GT(hard, 2 * soft) << guard;
    EXPECT_EQ(sut.loop.snapshot().faults, 0U);
  }
}

TEST(ImpedanceCommand, IsRefusedWhereThereIsNoneToTune) {
  Tuned sut(poking("arm.coupling.scheme=ghost-point"));
  sut.loop.run(1);
  const auto told = sut.tune("right", 10);
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().code, Errc::Unsupported);
  EXPECT_NE(told.error().message.find("has no impedance to tune"), std::string::npos);
  EXPECT_EQ(sut.tune("left", 10).error().code, Errc::NotFound);
}

}  // namespace
}  // namespace thimble
