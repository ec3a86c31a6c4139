#include "drivers/cambus/step_list_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/cambus/step_list_builder.hpp"
#include "drivers/cambus/step_list_check.hpp"
#include "tests/unit/cambus/hand_list.hpp"
#include "tests/unit/cambus/random_list.hpp"

namespace thimble::cambus {
namespace {

std::string text_of(StepListBuilder& builder) {
  const StepList list = builder.finish();
  return disassemble(list.view(), list.head);
}

TEST(StepListText, SaysWhatAProgramDoes) {
  StepListBuilder builder;
  builder.write(default_words(Register::Select));
  builder.write(RegisterWords(Register::Kick)
                    .set(field::kKickAmount, 1, 0x0001)
                    .set(field::kKickAmount, 512, 0x000c));
  builder.write(default_words(Register::Run));
  builder.raise_interrupt();
  builder.read(Register::Event, 25);
  builder.write_port(Register::LutIo, std::vector<std::uint16_t>(65536));
  builder.delay(100);
  EXPECT_EQ(text_of(builder),
            "0x10      write select: source 1 target 3\n"
            "0x20      write kick, wait: layer 0 amount 1; layer 1 0; layers 2-3 amount 0x200; "
            "layers 4-15 0\n"
            "0x70      write run, wait: sync 3; interrupt\n"
            "0x90      read event, 25 words to 0xa0\n"
            "0xe0      write lut-io, 65536 words of 0x0\n"
            "0xf0      delay 100 clocks; stop\n");
}

TEST(StepListText, SaysWhereAListLeavesItsWindowOrComesBack) {
  StepListBuilder builder;
  builder.delay(3);
  builder.reset(128);
  StepList list = builder.finish();
  list.bytes[0x11] = 0x80;  // jump, no stop
  EXPECT_EQ(disassemble(list.view(), list.head),
            "0x10      delay 3 clocks\n"
            "0x20      reset, 128 clocks; jump\n"
            "0x0       (no descriptor can lie here)\n");
  list.bytes[0x1c] = 0x10;
  EXPECT_EQ(disassemble(list.view(), list.head),
            "0x10      delay 3 clocks\n"
            "0x20      reset, 128 clocks; jump\n"
            "0x10      (again, from above)\n");
}

// So many writes of scan-perm from one buffer, in which no two layers are alike; then a stop.
StepList writes_of_one_buffer(int writes) {
  RegisterWords words(Register::ScanPerm);
  for (int layer = 0; layer < kLayers; ++layer) {
    for (const Field& of : field::kScanPerm) {
      words.set(of, static_cast<std::uint32_t>(1 + layer), static_cast<LayerMask>(1U << layer));
    }
  }
  StepListBuilder builder;
  builder.write(words);
  StepList list = builder.finish();
  const auto head = list.head - list.base;
  const std::vector<std::uint8_t> step(list.bytes.begin() + head,
                                       list.bytes.begin() + head + wire::kDescriptorBytes);
  list.head = static_cast<std::uint32_t>(list.base + list.bytes.size());
  for (int i = 0; i < writes; ++i) {
    const std::size_t at = list.bytes.size();
    list.bytes.insert(list.bytes.end(), step.begin(), step.end());
    test::put_word(list.bytes, static_cast<std::uint32_t>(at + 12),
                   static_cast<std::uint32_t>(list.base + list.bytes.size()));
    if (i + 1 < writes) list.bytes[at + 1] &= 0xbf;  // no stop: bit 14 of the opcode
  }
  return list;
}

TEST(StepListText, StepsOfOneBufferAreToldUpToABoundThatIsSaid) {
  const StepList list = writes_of_one_buffer(200);
  const std::string whole = disassemble(list.view(), list.head);
  ASSERT_GT(whole.size(), 100 * list.bytes.size());
  EXPECT_EQ(disassemble(list.view(), list.head, whole.size()), whole);
  const std::string cut = disassemble(list.view(), list.head, 10'000);
  const std::size_t last = cut.rfind('\n', cut.size() - 2) + 1;
  EXPECT_LE(last, 10'000U);
  EXPECT_GT(last, 10'000U - whole.size() / 100);
  EXPECT_EQ(cut.substr(0, last), whole.substr(0, last)) << "whole lines";
  EXPECT_NE(cut.find("(this and what follows would be a text of more than 10000 bytes)\n", last),
            std::string::npos);
}

TEST(StepListText, ShowsWhatMeansNothing) {
  const StepList list{16, 16, {0x1d, 0x41, 0, 0x20, 0xcd, 0xab, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}};
  EXPECT_EQ(disassemble(list.view(), 16),
            "0x10      write register 29, 1 words of 0xabcd; stop; unknown bits 0x100\n");
}

// A write of 20 words to register 18 with the flag of byte reads, and so many bytes behind it.
StepList write_flagged_as_bytes(std::size_t buffer_bytes) {
  StepList list{16, 16, {18, 0x40, 0, 0x10, 0x20, 0, 0, 0, 20, 0, 0, 0, 0, 0, 0, 0}};
  list.bytes.resize(list.bytes.size() + buffer_bytes);
  return list;
}

TEST(StepListText, AWriteSendsWordsWhateverItsFlagOfByteReadsSays) {
  const StepList whole = write_flagged_as_bytes(48);
  const Descriptor step = *descriptor_at(whole.view(), whole.head);
  EXPECT_EQ(step.buffer_bytes(), 48U);  // 40, rounded up
  EXPECT_TRUE(register_words(whole.view(), step).has_value());
  const StepList cut = write_flagged_as_bytes(32);
  EXPECT_FALSE(register_words(cut.view(), step).has_value());
  for (const StepList& list : {whole, cut}) {
    EXPECT_EQ(disassemble(list.view(), list.head),
              "0x10      write offset, 20 words from 0x20; stop; unknown bits 0x10000000\n");
  }
}

TEST(StepListText, HasALineForEachStep) {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const auto made = test::random_list(random);
    const std::string text = disassemble(made.list.view(), made.list.head);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), std::ptrdiff_t{made.steps});
    EXPECT_TRUE(text.ends_with("stop\n"));
  }
}

}  // namespace
}  // namespace thimble::cambus
