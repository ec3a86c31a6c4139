#include "hal/rt/triple_buffer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <thread>

namespace thimble::rt {
namespace {

TEST(TripleBuffer, IsEmptyUntilWritten) {
  TripleBuffer<int> sut;
  int out = 42;
  EXPECT_FALSE(sut.read(out));
  EXPECT_EQ(out, 42);
}

TEST(TripleBuffer, AnyInterleavingReadsTheLatestOnce) {
  std::mt19937 random(1);
  TripleBuffer<int> sut;
  int written = 0;
  bool is_unread = false;
  for (int step = 0; step < 10000; ++step) {
    if (random() % 2 == 0) {
      sut.write(++written);
      is_unread = true;
      continue;
    }
    int out = -1;
    ASSERT_EQ(sut.read(out), is_unread);
    ASSERT_EQ(out, is_unread ? written : -1);
    is_unread = false;
  }
}

TEST(TripleBuffer, AConcurrentReaderSeesWholeValuesInOrder) {
  using Frame = std::array<std::uint64_t, 16>;
  TripleBuffer<Frame> sut;
  constexpr std::uint64_t kLast = 20000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      Frame frame;
      frame.fill(i);
      sut.write(frame);
    }
  });

  std::uint64_t previous = 0;
  while (previous != kLast) {
    Frame frame;
    if (!sut.read(frame)) {
      std::this_thread::yield();
      continue;
    }
    for (const std::uint64_t word : frame) ASSERT_EQ(word, frame[0]);
    ASSERT_GT(frame[0], previous);
    previous = frame[0];
  }
  writer.join();
}

}  // namespace
}  // namespace thimble::rt
