#include "drivers/cambus/step_list_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/cambus/step_list_builder.hpp"
#include "drivers/cambus/step_list_check.hpp"
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
