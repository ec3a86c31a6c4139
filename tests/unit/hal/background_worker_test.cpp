#include "hal/linux/background_worker.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

namespace thimble::linux {
namespace {

constexpr auto kBeforeThisTestGivesUp = std::chrono::seconds(20);

TEST(BackgroundWorkerTest, DoesOneTaskAfterTheOtherInTheirOrder) {
  BackgroundWorker sut;
  std::vector<int> done;
  for (int i = 0; i < 100; ++i) {
    sut.post([&done, i] { done.push_back(i); });
  }
  sut.finish();
  ASSERT_EQ(done.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
}

// It would be the end of the process, with a force on every arm.
TEST(BackgroundWorkerTest, ATaskThatThrowsEndsNeitherTheProcessNorTheNextOne) {
  BackgroundWorker sut;
  bool is_next_done = false;
  sut.post([] { throw std::runtime_error("broken"); });
  sut.post([] { throw std::bad_alloc(); });
  sut.post([] { throw 1; });
  sut.post([&] { is_next_done = true; });
  sut.finish();
  EXPECT_TRUE(is_next_done);
}

// What a task owns may be a device whose closing lasts.
TEST(BackgroundWorkerTest, WhatATaskOwnsMayLastInItsEndAndHoldsUpNobodyWhoPosts) {
  BackgroundWorker sut;
  std::promise<void> ending;
  std::promise<void> posted;
  bool is_posted_meanwhile = false;
  auto owned = std::shared_ptr<int>(new int(1), [&](const int* value) {
    delete value;
    ending.set_value();
    is_posted_meanwhile =
        posted.get_future().wait_for(kBeforeThisTestGivesUp) == std::future_status::ready;
  });
  sut.post([kept = std::move(owned)] {});
  ending.get_future().wait();
  EXPECT_FALSE(sut.wait(Duration(0))) << "it is not over before";
  sut.post([] {});
  posted.set_value();
  sut.finish();
  EXPECT_TRUE(is_posted_meanwhile);
}

// As a reading that is late on a busy machine.
TEST(BackgroundWorkerTest, IsEndedBeforeItsThreadHasBegunAndDoesTheTaskStill) {
  for (int i = 0; i < 200; ++i) {
    const auto done = std::make_shared<std::promise<void>>();
    BackgroundWorker().post([done] { done->set_value(); });
    ASSERT_EQ(done->get_future().wait_for(kBeforeThisTestGivesUp), std::future_status::ready);
  }
}

TEST(BackgroundWorkerTest, IsEndedDuringATaskWithoutWaitingAndDoesNoFurtherOne) {
  const auto go_on = std::make_shared<std::promise<void>>();
  const auto is_over = std::make_shared<std::promise<void>>();
  const auto count = std::make_shared<std::atomic<int>>(0);
  auto sut = std::make_unique<BackgroundWorker>();
  std::promise<void> begun;
  sut->post([&begun, go_on, count] {
    begun.set_value();
    go_on->get_future().wait();
    ++*count;
  });
  // Its end tells that the thread has passed it by.
  sut->post([count, told = std::shared_ptr<int>(new int(1), [is_over](const int* value) {
                      delete value;
                      is_over->set_value();
                    })] { ++*count; });
  begun.get_future().wait();
  sut.reset();
  is_over->get_future().wait();
  EXPECT_EQ(*count, 0);
  go_on->set_value();
}

}  // namespace
}  // namespace thimble::linux
