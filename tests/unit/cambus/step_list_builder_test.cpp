#include "drivers/cambus/step_list_builder.hpp"

#include <gtest/gtest.h>

#include "drivers/cambus/step_list_check.hpp"
#include "tests/unit/cambus/random_list.hpp"

namespace thimble::cambus {
namespace {

using test::SentWords;
using Bytes = std::vector<std::uint8_t>;

// What a board would take from the list: read from its bytes, without the codec of the driver.
class PlainBoard {
 public:
  explicit PlainBoard(const StepList& list) : list_(list) {}

  std::vector<SentWords> run() const {
    std::vector<SentWords> sent;
    for (std::uint32_t at = list_.head;; at = word32(at + 12)) {
      const std::uint32_t opcode = word32(at);
      const bool is_immediate = ((opcode >> 29) & 1U) != 0;
      const bool is_read = ((opcode >> 30) & 1U) != 0;
      if (!is_read) sent.push_back(transfer(at, opcode, is_immediate));
      if (((opcode >> 14) & 1U) != 0) return sent;
    }
  }

 private:
  SentWords transfer(std::uint32_t at, std::uint32_t opcode, bool is_immediate) const {
    SentWords sent{static_cast<Register>(opcode & 31U), {}};
    const std::uint32_t from = is_immediate ? at + 4 : word32(at + 4);
    for (std::uint32_t k = 0; k < word32(at + 8); ++k) {
      const std::uint32_t place = from + 2 * (is_immediate ? k % 2 : k);
      sent.words.push_back(static_cast<std::uint16_t>(byte(place) | byte(place + 1) << 8));
    }
    return sent;
  }
  std::uint32_t byte(std::uint32_t at) const { return list_.bytes.at(at - list_.base); }
  std::uint32_t word32(std::uint32_t at) const {
    return byte(at) | byte(at + 1) << 8 | byte(at + 2) << 16 | byte(at + 3) << 24;
  }
  const StepList& list_;
};

TEST(StepListBuilder, AListWrittenByHand) {
  StepListBuilder sut;
  RegisterWords kick(Register::Kick);
  kick.set(field::kKickAmount, 1, 0x0001).set(field::kKickAmount, 2, 0x0100);
  sut.write(kick);
  sut.write(default_words(Register::Run));
  const StepList list = sut.finish();
  Bytes expected{0x02, 0x10, 0, 0, 0x20, 0, 0, 0, 30, 0, 0, 0, 0x60, 0, 0, 0};
  expected.insert(expected.end(), {0x01, 0x00, 0x00, 0x01});  // bits 0 and 1 of the amount
  expected.resize(0x60 - 0x10);
  const Bytes run{0x01, 0x50, 0, 0x00, 0, 0, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0};
  expected.insert(expected.end(), run.begin(), run.end());
  // The words of a run are 1 1 0 0 0 0: no two by turns, so they need a buffer.
  expected[0x50 + 4] = 0x70;
  expected.insert(expected.end(), {0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(list.head, 0x10U);
  EXPECT_EQ(list.bytes, expected);
}

TEST(StepListBuilder, TwoWordsByTurnsAreImmediate) {
  StepListBuilder sut;
  const std::vector<std::uint16_t> words{0x1234, 0x5678, 0x1234, 0x5678, 0x1234};
  sut.write_port(Register::LutIo, words);
  const StepList list = sut.finish();
  EXPECT_EQ(list.bytes, (Bytes{13, 0x40, 0, 0x20, 0x34, 0x12, 0x78, 0x56, 5, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(StepListBuilder, AReadTellsWhereItsWordsWillLie) {
  StepListBuilder sut(0x100);
  sut.delay(7);
  const ReadSlot slot = sut.read(Register::Event, 25);
  EXPECT_EQ(slot.offset, 0x120U);
  EXPECT_EQ(slot.words, 25U);
  const StepList list = sut.finish();
  EXPECT_EQ(list.base, 0x100U);
  EXPECT_EQ(list.bytes.size(), 0x20U + 64);  // 50 bytes, rounded up
}

TEST(StepListBuilder, AnEmptyListIsADelayOfOneClock) {
  StepListBuilder sut;
  const StepList list = sut.finish();
  EXPECT_EQ(list.bytes, (Bytes{0, 0x40, 0, 0x60, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(sut.finish().bytes, list.bytes);
}

TEST(StepListBuilder, WhateverIsBuiltArrivesInOrderAndIsTakenByTheChecker) {
  std::mt19937 random(20);
  for (int i = 0; i < 500; ++i) {
    const auto made = test::random_list(random, 16 * (1 + static_cast<std::uint32_t>(i % 5)));
    ASSERT_EQ(PlainBoard(made.list).run(), made.sent) << i;
    const auto summary = check_step_list(made.list.view(), made.list.head);
    ASSERT_TRUE(summary) << summary.error().message;
    EXPECT_EQ(summary->steps, made.steps);
    EXPECT_FALSE(summary->loops);
  }
}

TEST(StepListFile, ComesBackAsItWas) {
  std::mt19937 random(21);
  const auto made = test::random_list(random);
  const Bytes file = to_file(made.list);
  const auto list = parse_list_file({reinterpret_cast<const char*>(file.data()), file.size()});
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_EQ(list->bytes, made.list.bytes);
  EXPECT_EQ(list->head, made.list.head);
}

TEST(StepListFile, AnythingElseIsRefused) {
  const std::string file("CAMLIST1\x10\0\0\0\0\0\0\0", wire::kReservedBytes);
  EXPECT_TRUE(parse_list_file(file));
  EXPECT_FALSE(parse_list_file(file.substr(0, 15)));
  EXPECT_FALSE(parse_list_file(""));
  EXPECT_FALSE(parse_list_file("CAMLIST2" + file.substr(8)));
}

}  // namespace
}  // namespace thimble::cambus
