#include "tests/contract/memory_window_contract.hpp"

#include <array>
#include <random>

namespace thimble::test {

using Bytes = MemoryRig::Bytes;
using Words = std::vector<std::uint32_t>;
constexpr std::uint32_t kEnd = MemoryRig::kBytes;
constexpr std::uint32_t kUntouched = 0x12345678;

TEST_P(MemoryWindowContract, IsAsLargeAsTheMemoryAndAllZeroAtFirst) {
  EXPECT_EQ(sut.bytes(), MemoryRig::kBytes);
  Words words(MemoryRig::kBytes / 4, kUntouched);
  EXPECT_EQ(sut.read_block(0, words), IoStatus::Ok);
  EXPECT_EQ(words, Words(words.size(), 0));
}

TEST_P(MemoryWindowContract, AWordHasItsLowByteFirst) {
  EXPECT_EQ(sut.write(8, 0x01020304), IoStatus::Ok);
  sut.barrier();
  Bytes expected(MemoryRig::kBytes);
  expected[8] = 4;
  expected[9] = 3;
  expected[10] = 2;
  expected[11] = 1;
  EXPECT_EQ(rig->board_sees(), expected);
  rig->board_puts(kEnd - 4, {0xdd, 0xcc, 0xbb, 0xaa});
  std::uint32_t word = 0;
  EXPECT_EQ(sut.read(kEnd - 4, word), IoStatus::Ok);
  EXPECT_EQ(word, 0xaabbccdd);
}

TEST_P(MemoryWindowContract, WhatDoesNotLieWithinIsRefusedAndNothingMoves) {
  rig->board_puts(0, Bytes(MemoryRig::kBytes, 0x5a));
  const Bytes before = rig->board_sees();
  struct Range {
    std::uint32_t offset;
    std::size_t words;
  };
  for (const auto& [offset, size] : std::initializer_list<Range>{{1, 1},
                                                                 {2, 1},
                                                                 {kEnd - 3, 1},
                                                                 {kEnd, 1},
                                                                 {kEnd + 4, 1},
                                                                 {0xfffffffc, 1},
                                                                 {kEnd - 4, 2},
                                                                 {0, kEnd / 4 + 1},
                                                                 {0xfffffff8, 2},
                                                                 {kEnd + 4, 0},
                                                                 {2, 0}}) {
    Words words(size, kUntouched);
    EXPECT_EQ(sut.read_block(offset, words), IoStatus::ProtocolError) << offset << ' ' << size;
    EXPECT_EQ(words, Words(size, kUntouched));
    EXPECT_EQ(sut.write_block(offset, words), IoStatus::ProtocolError) << offset << ' ' << size;
    if (size != 1) continue;
    EXPECT_EQ(sut.read(offset, words[0]), IoStatus::ProtocolError) << offset;
    EXPECT_EQ(words[0], kUntouched);
    EXPECT_EQ(sut.write(offset, 0), IoStatus::ProtocolError) << offset;
  }
  EXPECT_EQ(rig->board_sees(), before);
}

TEST_P(MemoryWindowContract, NoWordsMayLieAtTheEnd) {
  EXPECT_EQ(sut.read_block(kEnd, {}), IoStatus::Ok);
  EXPECT_EQ(sut.write_block(kEnd, {}), IoStatus::Ok);
}

// Both sides write as they like; each sees what the other wrote last, and reading changes nothing.
TEST_P(MemoryWindowContract, RandomReadsAndWritesAreThoseOfPlainMemory) {
  std::mt19937 random(1);
  Words plain(MemoryRig::kBytes / 4);
  const auto number = [&](std::size_t below) { return random() % below; };
  for (int i = 0; i < 2000; ++i) {
    const std::size_t first = number(plain.size());
    const std::size_t size = number(std::min<std::size_t>(plain.size() - first, 40) + 1);
    const auto offset = static_cast<std::uint32_t>(4 * first);
    Words words(size);
    for (auto& word : words) word = static_cast<std::uint32_t>(random());
    switch (number(4)) {
      case 0:
        ASSERT_EQ(sut.write_block(offset, words), IoStatus::Ok);
        std::copy(words.begin(), words.end(), plain.begin() + static_cast<std::ptrdiff_t>(first));
        break;
      case 1:
        plain[first] = static_cast<std::uint32_t>(random());
        ASSERT_EQ(sut.write(offset, plain[first]), IoStatus::Ok);
        break;
      case 2: {
        plain[first] = static_cast<std::uint32_t>(random());
        sut.barrier();
        const std::uint32_t word = plain[first];
        rig->board_puts(
            offset, {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8),
                     static_cast<std::uint8_t>(word >> 16), static_cast<std::uint8_t>(word >> 24)});
        break;
      }
      default:
        ASSERT_EQ(sut.read_block(offset, words), IoStatus::Ok);
        ASSERT_TRUE(std::equal(words.begin(), words.end(),
                               plain.begin() + static_cast<std::ptrdiff_t>(first)))
            << i;
    }
  }
  for (std::size_t i = 0; i < plain.size(); ++i) {
    std::uint32_t word = 0;
    ASSERT_EQ(sut.read(static_cast<std::uint32_t>(4 * i), word), IoStatus::Ok);
    ASSERT_EQ(word, plain[i]) << i;
  }
}

TEST_P(MemoryWindowContract, AfterUnplugEveryCallSaysDisconnected) {
  ASSERT_EQ(sut.write(4, 7), IoStatus::Ok);
  rig->unplug();
  for (int i = 0; i < 3; ++i) {
    std::uint32_t word = kUntouched;
    EXPECT_EQ(sut.read(4, word), IoStatus::Disconnected);
    EXPECT_EQ(word, kUntouched);
    EXPECT_EQ(sut.write(4, 1), IoStatus::Disconnected);
    Words words(2);
    EXPECT_EQ(sut.read_block(4, words), IoStatus::Disconnected);
    EXPECT_EQ(sut.write_block(4, words), IoStatus::Disconnected);
    sut.barrier();
  }
  EXPECT_EQ(sut.bytes(), MemoryRig::kBytes);
}

TEST_P(MemoryWindowContract, AnUnplugIsFoundByAWrite) {
  rig->unplug();
  EXPECT_EQ(sut.write(0, 1), IoStatus::Disconnected);
}

TEST_P(MemoryWindowContract, AnUnplugIsFoundByABlock) {
  rig->unplug();
  Words words(MemoryRig::kBytes / 4);
  EXPECT_EQ(sut.read_block(0, words), IoStatus::Disconnected);
}

}  // namespace thimble::test
