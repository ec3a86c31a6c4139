// What the real bus makes of outputs that a chip refuses in part, over
// tests/support/fake_libgpiod.cpp.
#include <gtest/gtest.h>

#include <memory>

#include "hal/linux/gpio_transfers.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/fake_libgpiod.hpp"
#include "tests/support/temporary_folder.hpp"

namespace thimble::test {
namespace {

// Output 0 is line 4, output 1 is line 5.
struct GpioOutputsTest : testing::Test {
  sim::VirtualClock clock;
  testing_support::TemporaryFolder folder;
  FakeGpioChip chip{folder.path() / "gpiochip0", "bench", {"", "", "", "", "", ""}};
  bus::GpioMailboxes mail{1, 2, nullptr};
  std::unique_ptr<linux::GpioTransfers> sut =
      linux::GpioTransfers::open(folder.path(), {"bench", {"2"}, {"4", "5"}}, mail, clock).value();

  void settle() {
    clock.run_for(bus::kGpioReadPeriod);
    sut->serve();
  }
};

TEST_F(GpioOutputsTest, ALevelThatWasTakenWithoutAnAnswerIsUndone) {
  chip.fail_questions(true);
  EXPECT_EQ(mail.set(0, true), IoStatus::Ok);
  settle();
  ASSERT_TRUE(chip.wire(4)) << "the chip took it, and did not say so";
  chip.fail_questions(false);
  EXPECT_EQ(mail.set(0, false), IoStatus::Backlogged);
  settle();
  EXPECT_FALSE(chip.wire(4));
  EXPECT_EQ(mail.set(0, false), IoStatus::Ok);
}

TEST_F(GpioOutputsTest, TheOneOfTwoThatWasTakenIsUndoneWithTheOther) {
  chip.fail_line(5, true);
  mail.set(0, true);
  mail.set(1, true);
  settle();
  ASSERT_TRUE(chip.wire(4));
  mail.set(0, false);
  mail.set(1, false);
  settle();
  EXPECT_FALSE(chip.wire(4)) << "though the other is refused still";
  EXPECT_EQ(mail.set(1, false), IoStatus::Backlogged);
  chip.fail_line(5, false);
  settle();
  EXPECT_EQ(mail.set(1, false), IoStatus::Ok);
}

TEST_F(GpioOutputsTest, ARefusedOutputKeepsNoOtherWaiting) {
  chip.fail_line(4, true);
  mail.set(0, true);
  mail.set(1, true);
  settle();
  EXPECT_FALSE(chip.wire(4));
  EXPECT_TRUE(chip.wire(5));
  EXPECT_EQ(mail.set(1, true), IoStatus::Backlogged) << "not all is taken";
  chip.fail_line(4, false);
  settle();
  EXPECT_TRUE(chip.wire(4));
  EXPECT_EQ(mail.set(1, true), IoStatus::Ok);
}

}  // namespace
}  // namespace thimble::test
