#include "sim/model/cam/sync_pulses.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "sim/model/cam/video_monitor.hpp"

namespace thimble::sim::cam {
namespace {

TEST(SyncPulses, NoneRunWithoutClocksOrLines) {
  EXPECT_FALSE(SyncPulses().run());
  EXPECT_FALSE(SyncPulses({0, 0, 3, 2}, 7).run());
  EXPECT_FALSE(SyncPulses({60, 40, 0, 2}, 7).run());
  EXPECT_TRUE(SyncPulses({60, 0, 3, 0}, 7).run());
  EXPECT_TRUE(SyncPulses({0, 1, 1, 0}, 7).run());
}

TEST(SyncPulses, TheFirstBlankLineHasNoneOfItsOwn) {
  const SyncPulses sut({60, 40, 3, 2}, 1000);
  EXPECT_EQ(sut.next_line(1000), 1000U);
  EXPECT_EQ(sut.next_line(1001), 1100U);
  EXPECT_EQ(sut.next_line(1200), 1200U);
  EXPECT_EQ(sut.next_line(1201), 1400U);
  EXPECT_EQ(sut.next_line(1401), 1500U);
  EXPECT_EQ(sut.next_frame(1000), 1000U);
  EXPECT_EQ(sut.next_frame(1001), 1500U);
  EXPECT_EQ(sut.place_of(1499).line, 4U);
  EXPECT_EQ(sut.place_of(1500).frame, 1U);
}

// Two counters, clock by clock, that pulse where they begin.
class Counters {
 public:
  explicit Counters(const SyncLengths& lengths) : lengths_(lengths) {}
  struct Pulse {
    bool is_frame{false};
    std::uint64_t frame{0}, line{0};
  };
  std::optional<Pulse> tick() {
    const bool is_line = clock_ == 0;
    const bool is_for_monitor = lengths_.blank_lines > 0 && line_ == lengths_.scan_lines;
    const Pulse pulse{line_ == 0, frame_, line_};
    if (++clock_ == lengths_.scan_clocks + lengths_.blank_clocks) {
      clock_ = 0;
      if (++line_ == lengths_.scan_lines + lengths_.blank_lines) {
        line_ = 0;
        ++frame_;
      }
    }
    return is_line && !is_for_monitor ? std::optional(pulse) : std::nullopt;
  }

 private:
  SyncLengths lengths_;
  std::uint64_t clock_{0}, line_{0}, frame_{0};
};

TEST(SyncPulses, AreThoseOfTwoCounters) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const SyncLengths lengths{
        static_cast<std::uint32_t>(random() % 7), static_cast<std::uint32_t>(1 + random() % 5),
        static_cast<std::uint32_t>(1 + random() % 6), static_cast<std::uint32_t>(random() % 4)};
    const std::uint64_t start = random() % 1000;
    const SyncPulses sut(lengths, start);
    Counters counters(lengths);
    std::uint64_t asked_line = start;
    std::uint64_t asked_frame = start;
    for (std::uint64_t now = start; now < start + 400; ++now) {
      const auto pulse = counters.tick();
      if (!pulse) continue;
      for (; asked_line <= now; ++asked_line) ASSERT_EQ(sut.next_line(asked_line), now);
      EXPECT_EQ(sut.place_of(now).frame, pulse->frame);
      EXPECT_EQ(sut.place_of(now).line, pulse->line);
      if (!pulse->is_frame) continue;
      for (; asked_frame <= now; ++asked_frame) ASSERT_EQ(sut.next_frame(asked_frame), now);
    }
  }
}

TEST(VideoMonitor, HasTheLinesOfOneFrame) {
  VideoMonitor sut;
  EXPECT_EQ(sut.frames(), 0U);
  EXPECT_TRUE(sut.line(0).empty());
  sut.draw({4, 1}, std::vector<std::uint16_t>{1, 2});
  sut.draw({4, 3}, std::vector<std::uint16_t>{3});
  EXPECT_EQ(sut.frames(), 1U);
  EXPECT_TRUE(sut.line(0).empty());
  EXPECT_EQ(sut.line(1)[1], 2);
  EXPECT_EQ(sut.line(3)[0], 3);
  sut.draw({5, 3}, std::vector<std::uint16_t>{4});
  EXPECT_EQ(sut.frames(), 2U);
  EXPECT_TRUE(sut.line(1).empty());
  EXPECT_EQ(sut.line(3)[0], 4);
}

TEST(VideoMonitor, WhatNoMonitorShowsIsNotKept) {
  VideoMonitor sut;
  const std::vector<std::uint16_t> wide(VideoMonitor::kMostPixels + 1, 7);
  sut.draw({0, VideoMonitor::kMostLines}, wide);
  EXPECT_TRUE(sut.line(VideoMonitor::kMostLines).empty());
  sut.draw({0, VideoMonitor::kMostLines - 1}, wide);
  EXPECT_EQ(sut.line(VideoMonitor::kMostLines - 1).size(), VideoMonitor::kMostPixels);
}

}  // namespace
}  // namespace thimble::sim::cam
