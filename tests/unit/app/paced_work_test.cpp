#include "daemon/app/paced_work.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "sim/time/virtual_clock.hpp"

namespace thimble::app {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr api::ClientId kOne{1};
constexpr api::ClientId kOther{2};

class PacedWorkTest : public testing::Test {
 protected:
  // A piece that takes so long, and leaves its number.
  PacedWork::Piece piece(int number, Duration takes = milliseconds(0)) {
    return [this, number, takes] {
      done_.push_back(number);
      pass(takes);
    };
  }
  void pass(Duration time) { clock_.run_for(time); }
  void poll_for(Duration time) {
    for (Duration passed{}; passed < time; passed += milliseconds(1)) {
      sut_.poll();
      pass(milliseconds(1));
    }
  }

  sim::VirtualClock clock_;
  PacedWork sut_{clock_};
  std::vector<int> done_;
};

TEST_F(PacedWorkTest, DoesNothingWhereItIsAskedButWhenItIsPolled) {
  sut_.submit(kOne, piece(1));
  EXPECT_THAT(done_, IsEmpty());
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(1));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(1));
}

TEST_F(PacedWorkTest, DoesOnePieceATimeInTheOrderOfAsking) {
  for (int i = 0; i < 3; ++i) sut_.submit(i == 1 ? kOther : kOne, piece(i));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0));
  sut_.poll();
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0, 1, 2));
}

TEST_F(PacedWorkTest, RestsFourTimesAsLongAsAPieceTook) {
  sut_.submit(kOne, piece(0, milliseconds(16)));
  sut_.submit(kOther, piece(1));
  sut_.poll();
  pass(milliseconds(63));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0));
  pass(milliseconds(1));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0, 1));
}

TEST_F(PacedWorkTest, ThatRestedLongAgoMakesNobodyWait) {
  sut_.submit(kOne, piece(0, milliseconds(16)));
  sut_.poll();
  pass(milliseconds(1000));
  sut_.submit(kOne, piece(1));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0, 1));
}

TEST_F(PacedWorkTest, DoesNothingMoreForAClientThatIsGone) {
  for (int i = 0; i < 4; ++i) sut_.submit(i % 2 == 0 ? kOne : kOther, piece(i));
  sut_.client_gone(kOne);
  poll_for(milliseconds(10));
  EXPECT_THAT(done_, ElementsAre(1, 3));
}

TEST_F(PacedWorkTest, MayBeAskedAndLeftWithinAPiece) {
  sut_.submit(kOne, [this] {
    done_.push_back(0);
    sut_.client_gone(kOne);
    sut_.submit(kOther, piece(2));
  });
  sut_.submit(kOne, piece(1));
  poll_for(milliseconds(10));
  EXPECT_THAT(done_, ElementsAre(0, 2));
}

TEST_F(PacedWorkTest, WhatIsFinishedLaterIsDoneAtOnceAndRestedFrom) {
  sut_.submit(kOne, piece(0));
  sut_.submit(kOther, piece(2));
  sut_.poll();
  sut_.finish(piece(1, milliseconds(16)));
  EXPECT_THAT(done_, ElementsAre(0, 1));
  sut_.finish(piece(10));
  pass(milliseconds(63));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0, 1, 10)) << "a short one ends no rest";
  pass(milliseconds(1));
  sut_.poll();
  EXPECT_THAT(done_, ElementsAre(0, 1, 10, 2));
}

TEST_F(PacedWorkTest, KeepsNothingOfAPieceThatIsDone) {
  const auto held = std::make_shared<int>(0);
  sut_.submit(kOne, [held] {});
  EXPECT_EQ(held.use_count(), 2);
  sut_.poll();
  EXPECT_EQ(held.use_count(), 1);
}

// Whatever is asked by however many, it has a fifth of the thread, and everything is done in order.
TEST_F(PacedWorkTest, TakesAFifthOfTheTimeAtMostWhateverIsAsked) {
  std::mt19937 random(20261129);
  Duration worked{};
  int asked = 0;
  for (int round = 0; round < 20000; ++round) {
    if (random() % 3 == 0) {
      const Duration takes = milliseconds(random() % 20);
      sut_.submit(api::ClientId{random() % 40}, [this, takes, number = asked++, &worked] {
        done_.push_back(number);
        worked += takes;
        pass(takes);
      });
    }
    sut_.poll();
    pass(milliseconds(1));
  }
  ASSERT_GT(done_.size(), 100U);
  EXPECT_TRUE(std::is_sorted(done_.begin(), done_.end()));
  // And the last one, whose rest is not over.
  EXPECT_LE(worked * (1 + PacedWork::kRests),
            clock_.now().since_epoch + milliseconds(20) * (1 + PacedWork::kRests));
  EXPECT_GT(worked * 6, clock_.now().since_epoch) << "nothing was asked in earnest";
}

}  // namespace
}  // namespace thimble::app
