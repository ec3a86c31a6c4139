#include "lab/table_4_1/table_4_1.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "lab/table_4_1/contact_counts.hpp"
#include "lab/table_4_1/contacts.hpp"

namespace thimble::lab {
namespace {

ContactRun run_of(link::SendMode mode, HandKind hand, double delay_s, std::uint64_t contacts) {
  return {.mode = mode, .hand = hand, .impairment = {.delay_s = delay_s}, .contacts = contacts};
}

ContactStatistics contacts_of(const ContactRun& run) {
  const auto found = run_contacts(run);
  EXPECT_TRUE(found) << found.error().message;
  return found.value_or(ContactStatistics{});
}

// teleop.md section 4, "Expected single-approach result": computed there by other code.
TEST(Contacts, StreamedAreDisplacedAsTheFactsExpect) {
  struct Expected {
    double delay_s, offset_m;
  };
  for (const Expected& e : {Expected{0.02, 0.0037}, {0.05, 0.0097}, {0.1, 0.0197}, {0.2, 0.0397}}) {
    const ContactStatistics found =
        contacts_of(run_of(link::SendMode::Streamed, HandKind::Kinematic, e.delay_s, 30));
    EXPECT_EQ(found.offset_m.count(), 30U);
    EXPECT_NEAR(found.offset_m.mean(), e.offset_m, 0.00015) << e.delay_s;
    EXPECT_LT(found.offset_m.deviation(), 0.0001) << e.delay_s;
    EXPECT_EQ(found.at_end, 0U);
  }
}

TEST(Contacts, LockStepAreDisplacedOnceToTwiceTheDelay) {
  const ContactStatistics found =
      contacts_of(run_of(link::SendMode::LockStep, HandKind::Kinematic, 0.05, 300));
  EXPECT_NEAR(found.offset_m.mean(), 0.0146, 0.0005);
  EXPECT_NEAR(found.offset_m.deviation(), 0.0029, 0.0003);
  EXPECT_GT(found.offset_m.least(), 0.0094);
  EXPECT_LT(found.offset_m.most(), 0.0199);
}

TEST(Contacts, AtHalfASecondTheHandIsAtTheEndOfItsReach) {
  const ContactStatistics found =
      contacts_of(run_of(link::SendMode::Streamed, HandKind::Kinematic, 0.5, 10));
  EXPECT_EQ(found.at_end, 10U);
  EXPECT_NEAR(found.offset_m.mean(), 0.048, 1e-6);
}

// The same section, "H2 bounce test": streamed, at 100 ms.
TEST(Contacts, AFingerThatGivesWayIsDisplacedAsTheFactsExpect) {
  const ContactStatistics found =
      contacts_of(run_of(link::SendMode::Streamed, HandKind::Dynamic, 0.1, 60));
  EXPECT_NEAR(found.offset_m.mean(), 0.0121, 0.001);
  EXPECT_NEAR(found.change_m.mean(), 0.0169, 0.001);
}

TEST(Contacts, AFingerThatIsBackBeforeTheAnswerFeelsNothing) {
  const ContactStatistics found =
      contacts_of(run_of(link::SendMode::Streamed, HandKind::Dynamic, 0.5, 3));
  EXPECT_EQ(found.offset_m.count(), 0U);
}

TEST(Contacts, TheSameSeedGivesTheSameAndAnotherDoesNot) {
  ContactRun run = run_of(link::SendMode::LockStep, HandKind::Kinematic, 0.02, 20);
  run.impairment.jitter_s = 0.004;
  const double once = contacts_of(run).offset_m.mean();
  EXPECT_EQ(contacts_of(run).offset_m.mean(), once);
  run.seed = 2;
  EXPECT_NE(contacts_of(run).offset_m.mean(), once);
}

TEST(ContactCounts, RowsWithFewerContactsThanAskedFailAndAreNamed) {
  const ContactCount whole{"streamed, constant, 1 ms", 1000, 1000};
  EXPECT_TRUE(contact_criterion({whole, {"one more", 1000, 1001}}).is_met);
  const Criterion missed = contact_criterion(
      {whole, {"lock-step, loss 1 %, 500 ms", 4000, 3999}, {"finger, streamed, 1 ms", 1000, 0}});
  EXPECT_FALSE(missed.is_met);
  EXPECT_NE(missed.text.find("asked for: not lock-step, loss 1 %, 500 ms (3999 of 4000); finger, "
                             "streamed, 1 ms (0 of 1000)"),
            std::string::npos)
      << missed.text;
  EXPECT_EQ(missed.text.find(whole.row), std::string::npos);
  EXPECT_FALSE(contact_criterion({}).is_met) << "nothing was played";
}

TEST(Table41, AFewContactsAreNoMeanAndTheCriteriaSaySo) {
  const auto findings = run_table_4_1({.contacts = 1, .seed = 1});
  ASSERT_TRUE(findings) << findings.error().message;
  const auto met = std::count_if(findings->criteria.begin(), findings->criteria.end(),
                                 [](const Criterion& criterion) { return criterion.is_met; });
  EXPECT_FALSE(findings->is_met()) << tell(*findings);
  EXPECT_EQ(met, 6) << "those of lock-step are of a mean over its phases";
  EXPECT_EQ(findings->criteria.size(), 9U);
  EXPECT_NE(tell(*findings).find("as it must be: finger, streamed, 500 ms: 0 of 1 contacts"),
            std::string::npos);
  EXPECT_NE(tell(*findings).find("as it must be: each row, but the finger's, streamed, at 500 ms, "
                                 "has the contacts that were asked for\n"),
            std::string::npos);
  EXPECT_NE(tell(*findings).find("NOT as it must be: finger: offset"), std::string::npos);
  EXPECT_NE(tell(*findings).find("NOT as it must be: lock-step"), std::string::npos);
}

}  // namespace
}  // namespace thimble::lab
