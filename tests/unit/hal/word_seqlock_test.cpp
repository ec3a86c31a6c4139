#include "hal/rt/word_seqlock.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

namespace thimble::rt {
namespace {

struct OddSize {
  std::array<std::uint8_t, 13> bytes{};
  bool operator==(const OddSize&) const = default;
};

TEST(WordSeqlock, LoadsWhatWasStoredWhateverTheSize) {
  WordSeqlock<OddSize> sut;
  OddSize in;
  for (std::size_t i = 0; i < in.bytes.size(); ++i) in.bytes[i] = static_cast<std::uint8_t>(i + 1);

  sut.store(in);

  OddSize out;
  ASSERT_TRUE(sut.load(out));
  EXPECT_EQ(out, in);
}

TEST(WordSeqlock, ManyReadersNeverSeeATornValue) {
  using Frame = std::array<std::uint64_t, 16>;
  WordSeqlock<Frame> sut;
  std::atomic<bool> is_done{false};
  std::atomic<int> torn{0};
  std::vector<std::thread> readers;
  for (int r = 0; r < 2; ++r) {
    readers.emplace_back([&] {
      while (!is_done.load(std::memory_order_relaxed)) {
        Frame frame{};
        if (!sut.load(frame)) continue;
        for (const std::uint64_t word : frame) {
          if (word != frame[0]) torn.fetch_add(1);
        }
      }
    });
  }

  for (std::uint64_t i = 1; i <= 20000; ++i) {
    Frame frame;
    frame.fill(i);
    sut.store(frame);
    if (i % 64 == 0) std::this_thread::yield();
  }
  is_done = true;
  for (std::thread& reader : readers) reader.join();

  EXPECT_EQ(torn.load(), 0);
  Frame last{};
  ASSERT_TRUE(sut.load(last));
  EXPECT_EQ(last[0], 20000U);
}

}  // namespace
}  // namespace thimble::rt
