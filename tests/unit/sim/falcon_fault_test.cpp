#include <gtest/gtest.h>

#include <string_view>

#include "sim/model/falcon/falcon_arm_model.hpp"
#include "tests/support/falcon_image.hpp"
#include "tests/unit/sim/falcon_host.hpp"

namespace thimble::sim {
namespace {

using std::chrono::milliseconds;

TEST(FalconModel, ALostEchoFailsTheCheckAndTheNextUploadSucceeds) {
  FalconHost host;
  host.arm().set_faults({.lost_echo = 700, .deaf_questions = 1}, {});
  ASSERT_TRUE(host.greet());
  EXPECT_FALSE(host.upload(test::falcon_image()));
  ASSERT_TRUE(host.greet());
  EXPECT_TRUE(host.upload(test::falcon_image()));
}

TEST(FalconModel, DoesWrongWhatItsPanelIsToldOneBesideTheOther) {
  FalconHost host;
  plugin::ModelPanel& panel = *host.arm().panel();
  for (const auto& fault : panel.faults()) {
    EXPECT_EQ(fault.number, 0U) << fault.name;
    EXPECT_TRUE(panel.set_fault(fault.name, 7)) << fault.name;
  }
  for (const auto& fault : panel.faults()) {
    EXPECT_EQ(fault.number, 7U) << fault.name;
    EXPECT_TRUE(panel.set_fault(fault.name, 0)) << fault.name;
  }
  for (const auto& fault : panel.faults()) EXPECT_EQ(fault.number, 0U) << fault.name;
  EXPECT_FALSE(panel.set_fault("latency", 256)) << "a byte has no such number";
  EXPECT_FALSE(panel.set_fault("echo", 1));
  EXPECT_FALSE(panel.set_fault("", 1));

  EXPECT_TRUE(panel.set_fault("lost-echo", 700));
  EXPECT_TRUE(panel.set_fault("deaf", 1));
  EXPECT_TRUE(panel.set_fault("latency", 16));
  ASSERT_TRUE(host.greet());
  EXPECT_EQ(host.arm().processor().counters().questions, 2U);
  EXPECT_FALSE(host.upload(test::falcon_image()));
  ASSERT_TRUE(host.greet());
  ASSERT_TRUE(host.upload(test::falcon_image()));
  host.go_to_run_mode();
  EXPECT_EQ(host.arm().bridge().latency(), milliseconds(16));
  EXPECT_TRUE(panel.set_fault("latency", 0));
  EXPECT_EQ(host.arm().bridge().latency(), milliseconds(1));

  for (const auto& fault : panel.faults()) {
    EXPECT_EQ(fault.number, 0U) << fault.name << ", which has happened or was taken back";
  }

  EXPECT_TRUE(panel.set_fault("short-replies", 3));
  EXPECT_TRUE(panel.set_fault("glued-replies", 4));
  EXPECT_EQ(host.arm().processor().firmware().faults().short_every, 3U);
  EXPECT_EQ(host.arm().processor().firmware().faults().glue_every, 4U);
}

TEST(FalconModel, AFaultThatIsTakenBackDoesNotHappen) {
  FalconHost host;
  for (const std::string_view name : {"lost-echo", "deaf"}) {
    EXPECT_TRUE(host.arm().set_fault(name, 1));
    EXPECT_TRUE(host.arm().set_fault(name, 0));
  }
  ASSERT_TRUE(host.greet());
  EXPECT_TRUE(host.upload(test::falcon_image()));
}

}  // namespace
}  // namespace thimble::sim
