#include "tests/campaign/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble::campaign {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Tally of_everything() {
  Tally tally;
  for (std::size_t i = 0; i < kEventKindCount; ++i) {
    tally.events[i] = is_edit(static_cast<EventKind>(i)) ? 0 : 1;
  }
  for (std::size_t i = 0; i < sim::kFaultKindCount; ++i) tally.reports.by_kind[i] = 1;
  tally.recoveries_on_usb = tally.judged.ticks_due_on_usb = 1;
  tally.messages_lost = tally.messages_duplicated = tally.messages_reordered = tally.lies = 1;
  return tally;
}

TEST(CampaignReport, MissesNoFaultWhereEachStruckAtLeastOnce) {
  EXPECT_THAT(never_struck(of_everything()), IsEmpty());
}

TEST(CampaignReport, NamesEachFaultThatNeverStruckAsTheReportDoes) {
  Tally tally = of_everything();
  tally.events[static_cast<std::size_t>(EventKind::Shove)] = 0;
  tally.reports.by_kind[static_cast<std::size_t>(sim::FaultKind::DelayEvents)] = 0;
  tally.messages_reordered = 0;
  EXPECT_THAT(never_struck(tally), ElementsAre("shove", "events delayed", "messages reordered"));
}

TEST(CampaignReport, OfNothingNamesEveryKind) {
  constexpr std::size_t kEdits = 5;
  constexpr std::size_t events = kEventKindCount - kEdits;
  EXPECT_EQ(never_struck(Tally{}).size(), events + sim::kFaultKindCount + 6);
}

}  // namespace
}  // namespace thimble::campaign
