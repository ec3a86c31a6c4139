#include "drivers/cambus/step_list_check.hpp"

#include <gtest/gtest.h>

#include <string>

#include "drivers/cambus/step_list_builder.hpp"
#include "tests/unit/cambus/hand_list.hpp"
#include "tests/unit/cambus/random_list.hpp"

namespace thimble::cambus {
namespace {

// A window of zeros into which descriptors and words are put by hand.
class Window {
 public:
  static constexpr std::uint32_t kHead = 0x10;

  explicit Window(std::size_t bytes = 0x400) : bytes_(bytes) {}
  Window& step(std::uint32_t at, Descriptor what) {
    test::put_descriptor(bytes_, at, what.opcode, what.buffer, what.length, what.link);
    return *this;
  }
  Window& word(std::uint32_t at, std::uint16_t value) {
    bytes_.at(at) = static_cast<std::uint8_t>(value);
    bytes_.at(at + 1) = static_cast<std::uint8_t>(value >> 8);
    return *this;
  }
  // Why it is refused; empty when it is taken.
  std::string reason(const ListLimits& limits = {}, std::uint32_t head = kHead) const {
    const auto summary = check_step_list({0, bytes_}, head, limits);
    return summary ? "" : summary.error().message;
  }
  ListSummary summary(const ListLimits& limits = {}) const {
    return check_step_list({0, bytes_}, kHead, limits).value();
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

constexpr std::uint32_t op(Register number, std::uint32_t flags = 0) {
  return static_cast<std::uint32_t>(number) | flags;
}
constexpr std::uint32_t kNow = wire::kImmediate;
constexpr Descriptor kEnd{wire::kDelay | wire::kStop, 0, 1, 0};

// `what` first, then the end.
Window window_of(Descriptor what) {
  what.link = 0x20;
  return Window().step(0x10, what).step(0x20, kEnd);
}
std::string reason_for(const Descriptor& what, const ListLimits& limits = {}) {
  return window_of(what).reason(limits);
}

#define EXPECT_REASON(what, part) EXPECT_NE((what).find(part), std::string::npos) << (what)

TEST(StepListCheck, TellsWhatAListDoes) {
  StepListBuilder builder;
  builder.write(default_words(Register::Kick));
  builder.write(default_words(Register::Run));
  builder.read(Register::Event, 25);
  const StepList list = builder.finish();
  EXPECT_EQ(check_step_list(list.view(), list.head).value(),
            (ListSummary{.steps = 3, .runs = 1, .reads = 1, .words = 30 + 6 + 25}));
}

TEST(StepListCheck, SaysWhichStepAndWhere) {
  Window window;
  window.step(0x10, {wire::kDelay, 0, 1, 0x50}).step(0x50, {op(Register(29), kNow), 0, 1, 0x10});
  EXPECT_EQ(window.reason(), "step 2 at 0x50: register 29 does not exist");
}

TEST(StepListCheck, RegistersThatAreNotThere) {
  for (std::uint32_t number = 29; number < 32; ++number) {
    EXPECT_REASON(reason_for({number | kNow, 0, 1, 0}), "does not exist");
    EXPECT_REASON(reason_for({number | wire::kRead, 0x40, 1, 0}), "does not exist");
    EXPECT_EQ(reason_for({number | wire::kDelay, 0, 1, 0}), "");  // nothing moves
  }
}

TEST(StepListCheck, EveryRegisterHasOneLength) {
  for (const RegisterFacts& facts : kRegisters) {
    if (facts.bits == 0 || facts.number == Register::Event) continue;
    const std::uint32_t opcode = op(facts.number, kNow | wire::kWait);
    EXPECT_EQ(reason_for({opcode, 0, facts.bits, 0}), "") << facts.name;
    for (const std::uint32_t length : {0U, facts.bits - 1U, facts.bits + 1U, 0xffffffffU}) {
      EXPECT_REASON(reason_for({opcode, 0, length, 0}), "words, not");
    }
  }
}

TEST(StepListCheck, PortsAndCountersHaveARange) {
  const auto reason = [](Register port, std::uint32_t length) {
    StepListBuilder builder;
    builder.write_port(port, std::vector<std::uint16_t>(length));
    const StepList list = builder.finish();
    const auto summary = check_step_list(list.view(), list.head, {.module_sites = 4096});
    return summary ? "" : summary.error().message;
  };
  EXPECT_EQ(reason(Register::Event, 1), "");
  EXPECT_EQ(reason(Register::Event, 25), "");
  EXPECT_REASON(reason(Register::Event, 26), "1 to 25 words, not 26");
  EXPECT_EQ(reason(Register::LutIo, 65536), "");
  EXPECT_REASON(reason(Register::LutIo, 65537), "words, not");
  EXPECT_EQ(reason(Register::ScanIo, 4096), "");
  EXPECT_REASON(reason(Register::ScanIo, 4097), "words, not");
}

TEST(StepListCheck, BitsWithoutMeaning) {
  for (int bit = 0; bit < 32; ++bit) {
    const std::uint32_t flag = 1U << bit;
    if ((flag & wire::kOpcodeMask) != 0) continue;
    EXPECT_REASON(reason_for({wire::kDelay | flag, 0, 1, 0}), "bits that mean nothing");
  }
  EXPECT_REASON(reason_for({op(Register::Select, kNow | wire::kReset), 0, 3, 0}), "during a delay");
  EXPECT_REASON(reason_for({op(Register::Select, kNow | wire::kByteMode), 0, 3, 0}), "for reads");
  EXPECT_REASON(reason_for({wire::kDelay | wire::kByteMode, 0, 1, 0}), "for reads");
}

TEST(StepListCheck, FieldCodesWithoutMeaning) {
  for (std::uint32_t code = 0; code < 32; ++code) {
    StepListBuilder builder;
    builder.write(default_words(Register::LutPerm).set(field::kLutPerm[0], code, 0x0400));
    const StepList list = builder.finish();
    EXPECT_EQ(check_step_list(list.view(), list.head).has_value(),
              means_something(Codes::TableIndexOr01, code))
        << code;
  }
}

TEST(StepListCheck, DelaysThatTakeTooLong) {
  EXPECT_EQ(reason_for({wire::kDelay, 0, wire::kMaxDelayClocks, 0}), "");
  EXPECT_REASON(reason_for({wire::kDelay, 0, wire::kMaxDelayClocks + 1, 0}), "not within");
  EXPECT_REASON(reason_for({wire::kDelay, 0, 0, 0}), "not within");
}

TEST(StepListCheck, BuffersOutsideTheWindow) {
  const auto reason = [](std::uint32_t buffer) {
    return reason_for({op(Register::LutIo, wire::kRead), buffer, 16, 0});  // 32 bytes
  };
  EXPECT_EQ(reason(0x40), "");
  EXPECT_EQ(reason(0x3e0), "");
  for (const std::uint32_t buffer : {0x0U, 0x3f0U, 0x400U, 0x48U, 0xfffffff0U}) {
    EXPECT_REASON(reason(buffer), "not within the window");
  }
}

TEST(StepListCheck, ABufferIsRoundedUp) {
  const auto reason = [](std::uint32_t words, std::uint32_t flags) {
    return reason_for({op(Register::LutIo, wire::kRead | flags), 0x3f0, words, 0});
  };
  EXPECT_EQ(reason(8, 0), "");
  EXPECT_REASON(reason(9, 0), "buffer of 32 bytes");
  EXPECT_EQ(reason(16, wire::kByteMode), "");
  EXPECT_REASON(reason(17, wire::kByteMode), "buffer of 32 bytes");
}

TEST(StepListCheck, DescriptorsOutsideTheWindow) {
  for (const std::uint32_t link : {0x0U, 0x18U, 0x400U, 0xfffffff0U}) {
    Window window;
    window.step(0x10, {wire::kDelay, 0, 1, link});
    EXPECT_REASON(window.reason(), "no descriptor can lie there");
    EXPECT_REASON(Window().reason({}, link), "no descriptor can lie there");
  }
}

TEST(StepListCheck, ReadsIntoTheListItself) {
  const std::uint32_t read = op(Register::LutIo, wire::kRead);
  EXPECT_REASON(reason_for({read, 0x10, 8, 0}), "into the list itself");
  EXPECT_REASON(reason_for({read, 0x20, 8, 0}), "reads into this descriptor");
  EXPECT_EQ(reason_for({read, 0x30, 8, 0}), "");
}

TEST(StepListCheck, WhatIsReadMayBeWrittenBackButNotRun) {
  const auto reason = [](Register number) {
    const std::uint32_t bits = facts_of(number).bits;
    Window window;
    window.step(0x10, {op(number, wire::kRead | wire::kWait), 0x100, bits, 0x20})
        .step(0x20, {op(number, wire::kWait), 0x100, bits, 0x30})
        .step(0x30, kEnd);
    return window.reason();
  };
  EXPECT_EQ(reason(Register::ScanPerm), "");
  EXPECT_REASON(reason(Register::Run), "only known when");
}

TEST(StepListCheck, ARunIsNotOverwrittenForTheNextTimeThrough) {
  Window window;
  window.step(0x10, {op(Register::Run, wire::kWait), 0x100, 6, 0x20})
      .step(0x20, {op(Register::LutIo, wire::kRead | wire::kJump), 0x100, 8, 0x10});
  EXPECT_REASON(window.reason(), "into the list itself");
}

TEST(StepListCheck, LoopsThatNothingLetsOut) {
  Window window;
  window.step(0x10, {wire::kDelay | wire::kJump, 0, 1, 0x20})
      .step(0x20, {wire::kDelay, 0, 1, 0x30})
      .step(0x30, {wire::kDelay, 0, 1, 0x20});
  EXPECT_REASON(window.reason(), "nothing lets it out");  // the jump is before the loop
  window.step(0x30, {wire::kDelay | wire::kJump, 0, 1, 0x20});
  EXPECT_EQ(window.reason(), "");
  EXPECT_TRUE(window.summary().loops);
  EXPECT_EQ(window.summary().steps, 3U);
  window.step(0x10, {wire::kDelay, 0, 1, 0x10});
  EXPECT_REASON(window.reason(), "nothing lets it out");
}

TEST(StepListCheck, WhatWaitsMustWaitWhileAScanMayRun) {
  for (const RegisterFacts& facts : kRegisters) {
    if (facts.bits == 0) continue;
    const std::string reason = reason_for({op(facts.number, kNow), 0, facts.bits, 0});
    EXPECT_EQ(reason.find("has to wait") != std::string::npos, facts.waits) << facts.name;
  }
}

TEST(StepListCheck, OnceWaitedItIsQuietUntilTheNextRun) {
  const auto list = [](std::uint32_t sync) {
    Window window;
    window.step(0x10, {op(Register::Offset, kNow | wire::kWait), 0, 24, 0x20})
        .step(0x20, {op(Register::Run), 0x100, 6, 0x30})
        .step(0x30, {op(Register::Offset, kNow), 0, 24, 0x40})
        .step(0x40, kEnd)
        .word(0x100, (sync & 1U) != 0 ? 0xffff : 0)
        .word(0x102, (sync & 2U) != 0 ? 0xffff : 0);
    return window.reason();
  };
  EXPECT_EQ(list(kSyncNone), "");
  EXPECT_REASON(list(kSyncFree), "step 3 at 0x30: offset has to wait");
}

TEST(StepListCheck, ALoopComesBackWhileItsScanRuns) {
  Window window;
  window.step(0x10, {op(Register::Offset, kNow | wire::kWait), 0, 24, 0x20})
      .step(0x20, {op(Register::Offset, kNow), 0, 24, 0x30})
      .step(0x30, {op(Register::Run, kNow | wire::kJump), 0xffffffff, 6, 0x20});
  EXPECT_EQ(window.reason(),
            "step 2 at 0x20: offset has to wait for the end of the scan, and does not");
}

TEST(StepListCheck, ShowScanStaysWhileAScanMayRun) {
  const auto list = [](std::uint32_t sync, bool waits) {
    StepListBuilder builder;
    builder.write(default_words(Register::Offset));  // nothing runs
    builder.write(RegisterWords(Register::Run).set(field::kSync, sync));
    builder.write(RegisterWords(Register::ShowScan));
    StepList made = builder.finish();
    // The second byte of the last opcode.
    if (!waits) made.bytes.at(made.bytes.size() - wire::kDescriptorBytes + 1) &= 0xef;
    return check_step_list(made.view(), made.head).has_value();
  };
  EXPECT_FALSE(list(kSyncFree, false));
  EXPECT_TRUE(list(kSyncFree, true));
  EXPECT_TRUE(list(kSyncNone, false));
}

TEST(StepListCheck, SynchronisedScansNeedSync) {
  for (const std::uint32_t sync : {kSyncNone, kSyncLine, kSyncFrame, kSyncFree}) {
    StepListBuilder builder;
    builder.write(RegisterWords(Register::Run).set(field::kSync, sync, 0x0002));
    const StepList list = builder.finish();
    const bool is_synchronised = sync == kSyncLine || sync == kSyncFrame;
    EXPECT_EQ(check_step_list(list.view(), list.head).has_value(), !is_synchronised) << sync;
    EXPECT_TRUE(check_step_list(list.view(), list.head, {.has_sync = true})) << sync;
  }
}

TEST(StepListCheck, AfterScanIoComesADelay) {
  const Descriptor write{op(Register::ScanIo, kNow | wire::kWait), 0, 1, 0x20};
  const auto reason = [&](const Descriptor& next) {
    return Window().step(0x10, write).step(0x20, next).step(0x30, kEnd).reason();
  };
  EXPECT_EQ(reason({wire::kDelay, 0, 1062, 0x30}), "");  // of the longest refresh there is
  EXPECT_REASON(reason({wire::kDelay, 0, 1061, 0x30}), "1062 clocks or more behind it");
  EXPECT_REASON(reason({op(Register::Select, kNow), 0, 3, 0x30}), "behind it");
  for (const std::uint32_t leaves : {wire::kStop, wire::kJump, wire::kStop | wire::kJump}) {
    Descriptor leaving = write;
    leaving.opcode |= leaves;
    Window window;
    window.step(0x10, leaving).step(0x20, {wire::kDelay | wire::kStop, 0, 1062, 0});
    EXPECT_REASON(window.reason(), "step 1 at 0x10: a write to scan-io");
  }
  EXPECT_EQ(reason_for({op(Register::ScanIo, wire::kRead | wire::kWait), 0x40, 1, 0}), "");
}

TEST(StepListCheck, AListThatNeverEndsItsWordsIsTooLarge) {
  const std::uint32_t words = 1U << 22;
  Window window(0x2000 + 2 * words);
  const std::uint32_t steps = static_cast<std::uint32_t>(wire::kMaxListWords / words) + 1;
  for (std::uint32_t i = 0; i < steps; ++i) {
    window.step(0x10 + 16 * i,
                {op(Register::ScanIo, wire::kRead | wire::kWait), 0x2000, words, 0x20 + 16 * i});
  }
  EXPECT_REASON(window.reason(), "moves more than");
}

// Whoever follows a list that was taken stays within its bytes and comes to an end.
void expect_harmless(const WindowView& window, std::uint32_t head, const ListSummary& summary) {
  std::uint32_t at = head;
  for (std::uint32_t i = 0; i < summary.steps; ++i) {
    const auto step = descriptor_at(window, at);
    ASSERT_TRUE(step);
    ASSERT_TRUE(step->is_delay() || step->target());
    if (step->buffer_bytes() > 0) {
      ASSERT_GE(step->buffer, window.base);
      ASSERT_LE(step->buffer + step->buffer_bytes(), window.base + window.bytes.size());
    }
    if (step->has(wire::kStop)) return;
    at = step->link;
  }
  ASSERT_TRUE(summary.loops);
}

TEST(StepListCheck, WhatIsTakenIsHarmlessHoweverItWasDamaged) {
  std::mt19937 random(5);
  int taken = 0;
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    auto made = test::random_list(random);
    for (std::size_t hits = 1 + random() % 3; hits > 0; --hits) {
      auto& byte = made.list.bytes[random() % made.list.bytes.size()];
      byte = static_cast<std::uint8_t>(byte ^ (1U << (random() % 8)));
    }
    const auto summary = check_step_list(made.list.view(), made.list.head);
    ++(summary ? taken : refused);
    if (summary) expect_harmless(made.list.view(), made.list.head, *summary);
  }
  EXPECT_GT(taken, 300);
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace thimble::cambus
