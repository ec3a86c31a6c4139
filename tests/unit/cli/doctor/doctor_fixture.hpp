#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/doctor/checks.hpp"
#include "cli/doctor/read_facts.hpp"
#include "daemon/session/plugins.hpp"
#include "tests/unit/cli/doctor/planted_machine.hpp"

namespace thimble::doctor {

using testing::AllOf;
using testing::AnyOf;
using testing::Field;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

// Each test breaks one thing of a healthy machine: that check and no other one has to say so.
class Doctor : public testing::Test {
 protected:
  // Whoever runs the test owns the planted files and stands for root, its group for 'thimble'.
  [[nodiscard]] Facts facts(const config::Config& config = {}) const {
    Facts facts = read_facts(machine_.root(), plugins_.drivers, {}, config);
    give_away(facts.dma_latency);
    for (GpioChip& chip : facts.gpio_chips) give_away(chip.node);
    for (Controller& controller : facts.controllers) {
      give_away(controller.node);
      for (Node& node : controller.raw_nodes) give_away(node);
    }
    return facts;
  }
  static void give_away(Node& node) {
    if (node.user == ::geteuid()) node.user = 0;
    if (node.group == ::getegid()) node.group = PlantedMachine::kThimble;
  }
  [[nodiscard]] std::vector<Verdict> complaints() const { return complaints(facts()); }
  [[nodiscard]] static std::vector<Verdict> complaints(const Facts& facts) {
    std::vector<Verdict> verdicts = examine(facts);
    std::erase_if(verdicts, [](const Verdict& verdict) { return verdict.level == Level::Ok; });
    return verdicts;
  }
  // The one complaint, which must be complete.
  void expect_complaint(Level level, const std::string& check, const std::string& finding,
                        const std::string& command) const {
    expect_complaint(complaints(), level, check, finding, command);
  }
  static void expect_complaint(const std::vector<Verdict>& all, Level level,
                               const std::string& check, const std::string& finding,
                               const std::string& command) {
    expect_one(all, level, check, finding);
    if (all.size() != 1) return;
    EXPECT_THAT(all[0].command, HasSubstr(command));
  }
  // One that no command mends: there is only something to look at.
  void expect_look(Level level, const std::string& check, const std::string& finding,
                   const std::string& look_with) const {
    const std::vector<Verdict> all = complaints();
    expect_one(all, level, check, finding);
    if (all.size() != 1) return;
    EXPECT_EQ(all[0].command, "");
    EXPECT_THAT(all[0].look_with, HasSubstr(look_with));
    EXPECT_NE(all[0].advice, "");
  }
  static void expect_one(const std::vector<Verdict>& all, Level level, const std::string& check,
                         const std::string& finding) {
    ASSERT_THAT(all, SizeIs(1)) << check;
    EXPECT_EQ(all[0].level, level);
    EXPECT_EQ(all[0].check, check);
    EXPECT_THAT(all[0].finding, HasSubstr(finding));
    EXPECT_FALSE(all[0].reason.empty());
  }

  PlantedMachine machine_;
  session::Plugins plugins_;
};

}  // namespace thimble::doctor
