#include "daemon/devices/replaceable_device.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "daemon/devices/device_executor.hpp"

namespace thimble::devices {
namespace {

class CountingDevice final : public HapticDevice {
 public:
  CountingDevice(int id, std::atomic<int>& alive) : id_(id), alive_(alive) {
    ++alive_;
    capabilities_.model = "counting";
  }
  ~CountingDevice() override {
    is_dead_ = true;
    --alive_;
  }
  [[nodiscard]] const HapticCapabilities& capabilities() const noexcept override {
    return capabilities_;
  }
  [[nodiscard]] std::string_view calibration_instruction() const noexcept override {
    return "count";
  }
  [[nodiscard]] DeviceCounters counters() const noexcept override {
    DeviceCounters counters;
    counters.reports_in = static_cast<std::uint64_t>(id_);
    counters.malformed = 10 * counters.reports_in;
    return counters;
  }
  [[nodiscard]] std::optional<ZeroCommand> zero_command() const noexcept override { return {}; }
  void forget_calibration() noexcept override {}
  IoStatus read(HapticState& out) noexcept override {
    EXPECT_FALSE(is_dead_);
    out.sample_sequence = static_cast<std::uint64_t>(id_);
    return IoStatus::Ok;
  }
  IoStatus write(const LimitedWrench&) noexcept override {
    EXPECT_FALSE(is_dead_);
    return IoStatus::Ok;
  }

 private:
  int id_;
  std::atomic<int>& alive_;
  bool is_dead_{false};
  HapticCapabilities capabilities_;
};

TEST(ReplaceableDevice, ReadsTheNewDeviceAfterAnOffer) {
  std::atomic<int> alive{0};
  InlineExecutor work;
  ReplaceableDevice sut(std::make_unique<CountingDevice>(1, alive), work);
  HapticState state;
  sut.read(state);
  EXPECT_EQ(state.sample_sequence, 1U);

  std::unique_ptr<HapticDevice> next = std::make_unique<CountingDevice>(2, alive);
  ASSERT_TRUE(sut.offer(next));
  sut.read(state);

  EXPECT_EQ(state.sample_sequence, 2U);
}

TEST(ReplaceableDevice, KeepsTheOldDeviceUntilTheServoLetsGoOfIt) {
  std::atomic<int> alive{0};
  InlineExecutor work;
  ReplaceableDevice sut(std::make_unique<CountingDevice>(1, alive), work);
  std::unique_ptr<HapticDevice> second = std::make_unique<CountingDevice>(2, alive);
  std::unique_ptr<HapticDevice> third = std::make_unique<CountingDevice>(3, alive);
  ASSERT_TRUE(sut.offer(second));
  sut.collect();
  EXPECT_EQ(alive, 3);
  EXPECT_FALSE(sut.offer(third)) << "the servo has not taken the second yet";
  EXPECT_NE(third, nullptr);

  HapticState state;
  sut.read(state);
  EXPECT_TRUE(sut.offer(third));

  EXPECT_EQ(alive, 2) << "the first is gone, second waits for the servo's next read";
}

TEST(ReplaceableDevice, ARetiredDeviceIsClosedAndWhatItWasIsRemembered) {
  std::atomic<int> alive{0};
  InlineExecutor work;
  ReplaceableDevice sut(std::make_unique<CountingDevice>(7, alive), work);
  EXPECT_TRUE(sut.retire());
  EXPECT_FALSE(sut.retire()) << "once is enough";
  sut.collect();
  EXPECT_EQ(alive, 1) << "the servo has not let go of it yet";

  HapticState state;
  EXPECT_EQ(sut.read(state), IoStatus::Disconnected);
  sut.collect();

  EXPECT_EQ(alive, 0);
  EXPECT_EQ(sut.capabilities().model, "counting");
  EXPECT_EQ(sut.calibration_instruction(), "count");
  EXPECT_EQ(sut.counters().reports_in, 7U);
  EXPECT_EQ(sut.write(LimitedWrench::zero()), IoStatus::Disconnected);
}

// A status that told less after an arm was plugged in anew would hide what the new one does wrong.
TEST(ReplaceableDevice, CountsEveryDeviceOnceFromItsOfferOn) {
  std::atomic<int> alive{0};
  InlineExecutor work;
  ReplaceableDevice sut(std::make_unique<CountingDevice>(7, alive), work);
  HapticState state;
  const auto expect_malformed = [&](std::uint64_t counted) {
    EXPECT_EQ(sut.counters().malformed, counted);
    sut.read(state);
    EXPECT_EQ(sut.counters().malformed, counted);
    sut.collect();
    EXPECT_EQ(sut.counters().malformed, counted);
    sut.collect();
    EXPECT_EQ(sut.counters().malformed, counted);
  };
  expect_malformed(70);
  ASSERT_TRUE(sut.retire());
  EXPECT_FALSE(sut.has_reported()) << "nothing is there that could";
  expect_malformed(70);
  for (const int id : {2, 3}) {
    std::unique_ptr<HapticDevice> next = std::make_unique<CountingDevice>(id, alive);
    ASSERT_TRUE(sut.offer(next));
    EXPECT_TRUE(sut.has_reported());
    expect_malformed(id == 2 ? 90 : 120);
  }
  EXPECT_EQ(sut.counters().reports_in, 12U);
}

TEST(ReplaceableDevice, ARetiredDeviceIsReplacedByTheNext) {
  std::atomic<int> alive{0};
  InlineExecutor work;
  ReplaceableDevice sut(std::make_unique<CountingDevice>(1, alive), work);
  HapticState state;
  ASSERT_TRUE(sut.retire());
  sut.read(state);
  std::unique_ptr<HapticDevice> next = std::make_unique<CountingDevice>(2, alive);
  ASSERT_TRUE(sut.offer(next));
  EXPECT_EQ(sut.read(state), IoStatus::Ok);
  EXPECT_EQ(state.sample_sequence, 2U);
  EXPECT_TRUE(sut.retire()) << "a new device may go as well";
}

TEST(ReplaceableDevice, HandsOverWhileTheServoRuns) {
  std::atomic<int> alive{0};
  std::atomic<bool> is_done{false};
  {
    InlineExecutor work;
    ReplaceableDevice sut(std::make_unique<CountingDevice>(0, alive), work);
    std::thread servo([&] {
      HapticState state;
      while (!is_done) {
        sut.read(state);
        sut.write(LimitedWrench::zero());
        std::this_thread::yield();
      }
    });
    for (int id = 1; id <= 200;) {
      std::unique_ptr<HapticDevice> next = std::make_unique<CountingDevice>(id, alive);
      if (sut.offer(next)) ++id;
      std::this_thread::yield();
    }
    is_done = true;
    servo.join();
  }
  EXPECT_EQ(alive, 0) << "nothing leaks, nothing dies twice";
}

}  // namespace
}  // namespace thimble::devices
