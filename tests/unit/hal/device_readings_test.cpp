#include "hal/linux/device_readings.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "tests/rt/refused_threads.hpp"

namespace thimble::linux {
namespace {

constexpr Duration kAsLongAsItTakes = std::chrono::hours(1);
constexpr Duration kNotAtAll{0};

// A device that answers when the test says so.
class Gate {
 public:
  void open() {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return is_open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_open_{false};
};

ReadDevice device(const std::string& product) {
  ReadDevice read;
  read.device.info.product = product;
  return read;
}

// A device of one place.
SysfsPlace place(const std::string& identity) { return {identity, identity, identity}; }

struct DeviceReadingsTest : testing::Test {
  DeviceReadings sut;
  std::shared_ptr<Gate> gate = std::make_shared<Gate>();  // a reading may outlive the test

  std::string read(const std::string& identity, const std::string& product) {
    const auto got = sut.get(
        place(identity), [=] { return device(product); }, kAsLongAsItTakes);
    return got ? got->device.info.product : "nothing";
  }
  std::string read_behind_gate(const SysfsPlace& place, const std::string& product) {
    const auto slow = [gate = gate, product] {
      gate->pass();
      return std::optional(device(product));
    };
    const auto got = sut.get(place, slow, kNotAtAll);
    return got ? got->device.info.product : "nothing";
  }
  std::string read_behind_gate(const std::string& identity, const std::string& product) {
    return read_behind_gate(place(identity), product);
  }
  // An interface of the device at `port`, or of one that was there before.
  static SysfsPlace interface(const std::string& port, int number) {
    const std::string path = port + ":1." + std::to_string(number);
    return {path, path, port};
  }
  // Whoever hangs has a thread of its own and shares the gate with the test.
  std::size_t hanging() const { return static_cast<std::size_t>(gate.use_count()) - 1; }
  void wait_until_caught_up() {
    while (!sut.has_caught_up()) std::this_thread::yield();
  }
};

TEST_F(DeviceReadingsTest, GivesWhatIsRead) {
  EXPECT_EQ(read("a", "Arm"), "Arm");
  EXPECT_EQ(read("a", "Leg"), "Leg") << "read anew each time";
  EXPECT_FALSE(sut.get(
                      place("b"), [] { return std::nullopt; }, kAsLongAsItTakes)
                   .has_value());
  EXPECT_EQ(sut.late(), 0U);
}

TEST_F(DeviceReadingsTest, OneThatHangsHoldsUpNoOtherOne) {
  EXPECT_EQ(read_behind_gate("sick", "Arm"), "nothing");
  EXPECT_EQ(sut.late(), 1U);
  EXPECT_EQ(read("well", "Leg"), "Leg");
  EXPECT_EQ(read_behind_gate("sick too", "Arm"), "nothing");
  EXPECT_EQ(read("well", "Leg"), "Leg");
  EXPECT_EQ(sut.late(), 2U);
  gate->open();
}

TEST_F(DeviceReadingsTest, OneThatHangsIsNotAskedTwiceAndIsAsItWas) {
  EXPECT_EQ(read("sick", "Arm"), "Arm");
  EXPECT_EQ(read_behind_gate("sick", "Later"), "Arm");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(read("sick", "Never"), "Arm") << "waits for the first";
  EXPECT_EQ(sut.late(), 1U);
  EXPECT_FALSE(sut.has_caught_up());
  gate->open();
  wait_until_caught_up();
  EXPECT_EQ(read("sick", "Never"), "Later") << "what it said at last";
  EXPECT_FALSE(sut.has_caught_up());
  EXPECT_EQ(read("sick", "Now"), "Now");
}

TEST_F(DeviceReadingsTest, OneThatIsGoneIsForgottenWithItsReading) {
  EXPECT_EQ(read("sick", "Arm"), "Arm");
  EXPECT_EQ(read_behind_gate("sick", "Later"), "Arm");
  sut.keep({"well"});
  EXPECT_EQ(sut.late(), 0U);
  EXPECT_EQ(read("sick", "Another"), "Another");
  gate->open();
  EXPECT_FALSE(sut.has_caught_up());
}

TEST_F(DeviceReadingsTest, ManyThatHangTakeFewThreadsAndTheRestIsPutOff) {
  constexpr std::size_t kMost = DeviceReadings::kMostLeft;
  EXPECT_EQ(read("well", "Leg"), "Leg");
  for (int look = 0; look < 3; ++look) {
    for (int i = 0; i < 64; ++i) read_behind_gate("sick " + std::to_string(i), "Arm");
  }
  EXPECT_EQ(hanging(), kMost);
  EXPECT_EQ(sut.late(), kMost);
  EXPECT_EQ(sut.put_off(), 64 - kMost);
  EXPECT_EQ(read("well", "Never"), "Leg") << "as it was";
  EXPECT_FALSE(sut.has_caught_up());
  gate->open();
  wait_until_caught_up();
  for (int i = 0; i < 64; ++i) {
    const std::string name = "sick " + std::to_string(i);
    while (read(name, "Arm") == "nothing") std::this_thread::yield();
  }
  EXPECT_EQ(read("well", "Now"), "Now");
  EXPECT_EQ(sut.late(), 0U);
  EXPECT_EQ(sut.put_off(), 0U);
  EXPECT_FALSE(sut.has_caught_up());
}

// A device that comes and goes anew each time hangs under another name each time.
TEST_F(DeviceReadingsTest, ThreadsOfDevicesThatAreGoneCount) {
  for (int i = 0; i < 64; ++i) {
    const std::string name = "sick " + std::to_string(i);
    read_behind_gate(name, "Arm");
    sut.keep({name});
  }
  EXPECT_EQ(hanging(), DeviceReadings::kMostLeft);
  EXPECT_EQ(sut.late(), 0U);
  EXPECT_EQ(sut.put_off(), 1U);
  sut.keep({});
  EXPECT_EQ(sut.put_off(), 0U);
  gate->open();
}

TEST_F(DeviceReadingsTest, ADeviceOfManyInterfacesThatHangTakesTwoThreadsAndNoOtherDevicesPlace) {
  constexpr std::size_t kMostOfOne = DeviceReadings::kMostLeftOfOne;
  for (int look = 0; look < 3; ++look) {
    for (int i = 0; i < 8; ++i) read_behind_gate(interface("1-4", i), "Arm");
  }
  EXPECT_EQ(hanging(), kMostOfOne);
  EXPECT_EQ(sut.late(), kMostOfOne);
  EXPECT_EQ(sut.put_off(), 8 - kMostOfOne);
  EXPECT_FALSE(sut.has_caught_up());
  for (int i = 0; i < 6; ++i) {
    const std::string name = "sick " + std::to_string(i);
    EXPECT_EQ(read("well " + std::to_string(i), "Leg"), "Leg") << i << " hang beside it";
    read_behind_gate(name, "Arm");
  }
  EXPECT_EQ(hanging(), DeviceReadings::kMostLeft);
  EXPECT_EQ(read("well", "Leg"), "nothing") << "all eight hang";
  gate->open();
}

TEST_F(DeviceReadingsTest, WhatIsPutOffForItsOwnDeviceIsReadWhenOneOfItsThreadsEnds) {
  const auto other_gate = std::make_shared<Gate>();
  read_behind_gate(interface("1-4", 0), "Arm");
  const auto first_to_end = [other_gate] {
    other_gate->pass();
    return std::optional(device("Leg"));
  };
  EXPECT_FALSE(sut.get(interface("1-4", 1), first_to_end, kNotAtAll));
  EXPECT_EQ(read_behind_gate(interface("1-4", 2), "Arm"), "nothing");
  EXPECT_EQ(hanging(), 1U) << "it was not asked";
  ASSERT_EQ(sut.put_off(), 1U);
  sut.keep({interface("1-4", 0).identity, interface("1-4", 2).identity});
  EXPECT_FALSE(sut.has_caught_up()) << "the thread of what is gone is the device's still";
  other_gate->open();
  wait_until_caught_up();
  const auto got = sut.get(
      interface("1-4", 2), [] { return device("Leg"); }, kAsLongAsItTakes);
  ASSERT_TRUE(got.has_value());
  EXPECT_EQ(got->device.info.product, "Leg");
  EXPECT_EQ(sut.put_off(), 0U);
  EXPECT_FALSE(sut.has_caught_up());
  gate->open();
}

// As one does that resets itself: another identity, the same port.
TEST_F(DeviceReadingsTest, ADeviceThatComesAnewAndHangsEachTimeTakesTwoThreadsInAll) {
  for (int i = 0; i < 64; ++i) {
    const SysfsPlace one{"1-4", "1-4 " + std::to_string(i), "1-4"};
    read_behind_gate(one, "Arm");
    sut.keep({one.identity});
  }
  EXPECT_EQ(hanging(), DeviceReadings::kMostLeftOfOne);
  EXPECT_EQ(read("well", "Leg"), "Leg");
  gate->open();
}

TEST_F(DeviceReadingsTest, ItsEndWaitsForNoReading) {
  {
    DeviceReadings brief;
    const auto slow = [gate = gate] {
      gate->pass();
      return std::optional(device("Arm"));
    };
    EXPECT_FALSE(brief.get(place("sick"), slow, kNotAtAll).has_value());
  }
  gate->open();
}

TEST_F(DeviceReadingsTest, OneThatNoThreadCouldBeHadForIsReadLater) {
  {
    const test::RefusedThreads none(test::RefusedThreads::Which::All);
    EXPECT_EQ(read("a", "Arm"), "nothing");
    EXPECT_EQ(sut.put_off(), 1U);
  }
  EXPECT_TRUE(sut.has_caught_up()) << "whoever waits for a device asks again for that";
  EXPECT_EQ(read("a", "Arm"), "Arm");
  EXPECT_EQ(sut.put_off(), 0U);
  EXPECT_FALSE(sut.has_caught_up());
}

TEST_F(DeviceReadingsTest, OneThatThrowsGivesNothingAndIsNotLate) {
  const auto throwing = []() -> std::optional<ReadDevice> { throw std::runtime_error("broken"); };
  EXPECT_FALSE(sut.get(place("a"), throwing, kAsLongAsItTakes));
  EXPECT_EQ(sut.late(), 0U);
  EXPECT_EQ(read("a", "arm"), "arm") << "the next time";
}

}  // namespace
}  // namespace thimble::linux
