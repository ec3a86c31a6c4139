#include "daemon/app/device_threads.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "hal/linux/monotonic_clock.hpp"

namespace thimble::app {
namespace {

config::Config two_real_arms_and_a_simulated_one() {
  config::Config config;
  for (const auto& [name, device] :
       {std::pair{"left", "hid:left"}, {"right", "usb:1-4"}, {"toy", "sim:falcon"}}) {
    config.arms.emplace_back().name = name;
    config.arms.back().device = device;
  }
  for (const auto kind : {config::PieceBoardKind::Usb, config::PieceBoardKind::SimUsb}) {
    config.worlds.emplace_back().pieces = config::PiecesConfig{.board = kind};
    config.worlds.back().name = kind == config::PieceBoardKind::Usb ? "left" : "toy";
  }
  return config;
}

struct DeviceThreadsTest : testing::Test {
  std::unique_ptr<DeviceThreads> sut =
      DeviceThreads::start(two_real_arms_and_a_simulated_one()).value();
};

TEST_F(DeviceThreadsTest, WhatIsPostedIsDoneInOrderInAThreadOfItsOwn) {
  std::vector<int> done;
  std::thread::id thread;
  for (int i = 0; i < 50; ++i) {
    sut->executor_for("left").post([&, i] {
      done.push_back(i);
      thread = std::this_thread::get_id();
    });
  }
  sut.reset();
  ASSERT_EQ(done.size(), 50U) << "its end waits for all of it";
  for (int i = 0; i < 50; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  EXPECT_NE(thread, std::this_thread::get_id());
}

TEST_F(DeviceThreadsTest, AnArmThatHangsHoldsUpNeitherTheCallerNorAnotherArm) {
  std::promise<void> answer;
  std::promise<void> other;
  std::atomic<bool> is_left_done{false};
  sut->executor_for("left").post([&] {
    answer.get_future().wait();
    is_left_done = true;
  });
  sut->executor_for("right").post([&] { other.set_value(); });
  other.get_future().wait();
  EXPECT_FALSE(is_left_done);
  answer.set_value();
  sut.reset();
  EXPECT_TRUE(is_left_done);
}

TEST_F(DeviceThreadsTest, NamesTheArmThatIsNotDoneAndWaitsForTheOthers) {
  const linux::MonotonicClock clock;
  std::promise<void> answer;
  std::atomic<bool> is_right_done{false};
  sut->executor_for("left").post([&] { answer.get_future().wait(); });
  sut->executor_for("right").post([&] { is_right_done = true; });
  EXPECT_EQ(sut->late_after(std::chrono::milliseconds(1), clock).front(), "arm 'left'");
  answer.set_value();
  EXPECT_TRUE(sut->late_after(std::chrono::hours(1), clock).empty());
  EXPECT_TRUE(is_right_done);
}

TEST_F(DeviceThreadsTest, ABoardOfAWorldHasOneOfItsOwnWhateverAnArmIsCalled) {
  const linux::MonotonicClock clock;
  EXPECT_NE(&sut->executor_for_board("left"), &sut->executor_for("left"));
  std::promise<void> answer;
  sut->executor_for_board("left").post([&] { answer.get_future().wait(); });
  EXPECT_EQ(sut->late_after(std::chrono::milliseconds(1), clock),
            std::vector<std::string>{"the board of world 'left'"});
  answer.set_value();
  sut.reset();  // what waits for the answer is over before the answer goes
}

TEST_F(DeviceThreadsTest, WhatIsSimulatedHasNone) {
  EXPECT_THROW(static_cast<void>(sut->executor_for("toy")), std::out_of_range);
  EXPECT_THROW(static_cast<void>(sut->executor_for_board("toy")), std::out_of_range);
  config::Config config;
  EXPECT_FALSE(has_real_device(config));
  config.worlds.emplace_back().pieces = config::PiecesConfig{};
  EXPECT_FALSE(has_real_device(config));
  for (const auto kind : {config::PieceBoardKind::Usb, config::PieceBoardKind::Pci}) {
    config.worlds.back().pieces->board = kind;
    EXPECT_TRUE(has_real_device(config));
  }
}

}  // namespace
}  // namespace thimble::app
