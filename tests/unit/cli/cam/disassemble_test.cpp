#include "cli/cam/disassemble.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/cambus/step_list_builder.hpp"

namespace thimble::cam {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

std::string file_of(cambus::StepListBuilder& builder) {
  const auto bytes = cambus::to_file(builder.finish());
  return {bytes.begin(), bytes.end()};
}

std::string frame_run() {
  cambus::StepListBuilder builder;
  builder.write(
      cambus::RegisterWords(cambus::Register::Run).set(cambus::field::kSync, cambus::kSyncFrame));
  return file_of(builder);
}

TEST(ReportList, EndsWithWhatTheStepsComeTo) {
  cambus::StepListBuilder builder;
  builder.write(cambus::default_words(cambus::Register::Run));
  builder.read(cambus::Register::Event, 25);
  builder.delay(4);
  const auto report = report_list(file_of(builder), {});
  ASSERT_TRUE(report);
  EXPECT_THAT(report->text, EndsWith("; stop\n3 steps, 31 words, 1 run, 1 read\n"));
  EXPECT_EQ(report->refusal, "");
}

TEST(ReportList, ARefusedListIsShownAllTheSame) {
  const auto report = report_list(frame_run(), {});
  ASSERT_TRUE(report);
  EXPECT_THAT(report->text, EndsWith("sync 1; stop\n"));
  EXPECT_THAT(report->refusal, HasSubstr("step 1 at 0x10: a synchronised scan would never end"));
}

TEST(ReportList, WithSyncItIsTaken) {
  const auto report = report_list(frame_run(), {.has_sync = true});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->refusal, "");
}

TEST(ReportList, OtherFilesAreErrors) {
  EXPECT_EQ(report_list("not a list", {}).error().code, Errc::Malformed);
  EXPECT_EQ(report_list(std::string(kMaxListBytes + 1, ' '), {}).error().code, Errc::TooLarge);
}

}  // namespace
}  // namespace thimble::cam
