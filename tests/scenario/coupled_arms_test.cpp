// Two arms that are coupled to each other (thesis 5.3.5), in whole sessions.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/support/closed_loop.hpp"

namespace thimble {
namespace {

using test::ClosedLoop;

std::string coupled_arms(const std::string& first, const std::string& second) {
  const auto arm = [](const std::string& name, const std::string& peer, const std::string& scheme) {
    // Of a follower as heavy as a hand, so that it does not swing.
    const std::string tool = scheme == "spring-damper"
                                 ? "stiffness_newton_per_m = 300\ndamping_newton_s_per_m = 10\n"
                                 : "";
    return "[[arm]]\nname = \"" + name +
           "\"\ndevice = \"sim:phantom-vintage\"\namplifier_max_a = 3.0\npeer = \"" + peer +
           "\"\n[arm.hand]\nmotion = \"still\"\nstiffness_newton_per_m = " +
           (name == "here" ? "50" : "500") +
           "\ndamping_newton_s_per_m = 20\n[arm.coupling]\nscheme = \"" + scheme + "\"\n" + tool +
           "[arm.impairment]\ndelay_s = 0.02\n";
  };
  return arm("here", "there", first) + arm("there", "here", second);
}

class CoupledArms : public testing::TestWithParam<std::pair<std::string, std::string>> {};
INSTANTIATE_TEST_SUITE_P(, CoupledArms,
                         testing::Values(std::pair{"spring-damper", "spring-damper"},
                                         std::pair{"wave", "wave"},
                                         std::pair{"ghost-point", "spring-damper"}),
                         [](const auto& of) {
                           const std::string& first = of.param.first;
                           return std::string(first == "wave"          ? "Wave"
                                              : first == "ghost-point" ? "Touch"
                                                                       : "SpringDamper");
                         });

TEST_P(CoupledArms, WhatOnePersonDoesTheOtherFeels) {
  const auto& [first, second] = GetParam();
  ClosedLoop::Setup setup;
  setup.text = coupled_arms(first, second);
  ClosedLoop sut({}, setup);
  sut.run_until_driven();
  sut.run(1);
  sut.sim_arm(0).backend().push_tip({3, 0, 0});
  sut.run(6);
  EXPECT_GT(sut.frame(1).tip.x, 0.4e-3) << "the other arm is drawn along";
  EXPECT_GT(sut.frame(1).force.x, 0.2);
  EXPECT_LT(sut.frame(0).force.x, -0.2) << "and its person is felt";
  EXPECT_EQ(sut.snapshot(0).faults + sut.snapshot(1).faults, 0U);
}

TEST_P(CoupledArms, WhenOneIsLetGoTheOtherIs) {
  const auto& [first, second] = GetParam();
  ClosedLoop::Setup setup;
  setup.text = coupled_arms(first, second);
  ClosedLoop sut({}, setup);
  sut.run_until_driven();
  sut.sim_arm(0).backend().push_tip({3, 0, 0});
  sut.run(4);
  ASSERT_GT(norm(sut.frame(0).force), 0.2);
  sut.arm(1).session().controls().want_active = false;
  sut.run(2);
  EXPECT_TRUE(sut.frame(0).is_fading);
  EXPECT_EQ(norm(sut.frame(0).force), 0);
  sut.arm(1).session().controls().want_active = true;
  sut.run(3);
  EXPECT_FALSE(sut.frame(0).is_fading) << "and found again";
  EXPECT_EQ(sut.snapshot(0).faults + sut.snapshot(1).faults, 0U);
}

}  // namespace
}  // namespace thimble
