#include "cli/doctor/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/json.hpp>

namespace thimble::doctor {
namespace {

using testing::HasSubstr;

std::vector<Verdict> sample() {
  return {
      all_well("kernel", "Linux 6.1, PREEMPT_RT"),
      {Level::Warn, "clock", "slow", "costs time", "", "look there", "cat /sys/clock"},
      {Level::Wrong, "rtprio", "may not", std::string(100, 'x') + " end",
       "echo 'a line that is longer than a terminal is wide' | sudo tee -a /etc/security/a", ""}};
}

TEST(DoctorReport, SaysWhatWhyAndWhatMends) {
  const std::string text = render(sample());

  EXPECT_THAT(text, HasSubstr("ok     kernel: Linux 6.1, PREEMPT_RT\n"));
  EXPECT_THAT(text, HasSubstr("warn   clock: slow\n       why: costs time\n"
                              "       look: cat /sys/clock\n       (look there)\n"));
  EXPECT_THAT(text, HasSubstr("WRONG  rtprio: may not\n"));
  EXPECT_THAT(text, HasSubstr("is wide' | sudo tee -a /etc/security/a\n")) << "never cut";
  EXPECT_THAT(text, HasSubstr("mend: echo 'a line"));
  EXPECT_THAT(text, testing::EndsWith("1 ok, 1 to improve, 1 wrong\n"));
}

TEST(DoctorReport, LetsNoControlCharacterOfADeviceThrough) {
  const std::vector<Verdict> verdicts{all_well("node", "a\x1b[2J")};
  EXPECT_THAT(render(verdicts), testing::Not(HasSubstr("\x1b")));
  EXPECT_THAT(to_json(verdicts), HasSubstr("a?[2J"));
}

TEST(DoctorReport, IsAlsoAJsonDocument) {
  const auto document = boost::json::parse(to_json(sample())).as_object();

  EXPECT_TRUE(document.at("wrong").as_bool());
  const auto& checks = document.at("checks").as_array();
  ASSERT_EQ(checks.size(), 3U);
  EXPECT_EQ(checks[0].at("level").as_string(), "ok");
  EXPECT_EQ(checks[1].at("command").as_string(), "");
  EXPECT_EQ(checks[1].at("look_with").as_string(), "cat /sys/clock");
  EXPECT_EQ(checks[2].at("check").as_string(), "rtprio");
}

TEST(DoctorReport, CallsOnlyWhatIsWrongWrong) {
  std::vector<Verdict> verdicts = sample();
  EXPECT_TRUE(is_something_wrong(verdicts));
  verdicts.pop_back();
  EXPECT_FALSE(is_something_wrong(verdicts));
}

}  // namespace
}  // namespace thimble::doctor
