#include <gtest/gtest.h>

#include <functional>

#include "drivers/cambus/list_player.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/bus/sim_memory_window.hpp"

// A page that a test writes word by word: what a board may say that is broken.
namespace thimble::cambus {
namespace {

using std::chrono::milliseconds;
constexpr std::size_t kBytes = 0x2000;

// The words of a sound board that waits.
std::shared_ptr<sim::SimMemory> sound_page() {
  auto memory = std::make_shared<sim::SimMemory>(kBytes);
  const bus::SharedWords words = memory->words();
  words.store(0x000, 0x384d4143);
  words.store(0x004, 1);
  words.store(0x008, 0x1000);
  words.store(0x00c, 0x1000);
  words.store(0x010, 0x16010101);
  words.store(0x014, 25'000'000);
  words.store(0x018, 7);
  words.store(0x800, page::kIsWaiting);
  return memory;
}

Result<std::unique_ptr<PciPort>> open(const std::shared_ptr<sim::SimMemory>& memory) {
  return PciPort::open(std::make_unique<sim::SimMemoryWindow>(memory), {});
}

TEST(StrangeBoard, FactsThatCannotBeAreRefused) {
  struct Case {
    std::uint32_t offset, word;
    Errc code;
  };
  for (const Case& wrong : std::initializer_list<Case>{{0x000, 0xffffffff, Errc::NotMine},
                                                       {0x000, 0x43414d38, Errc::NotMine},
                                                       {0x004, 2, Errc::Unsupported},
                                                       {0x008, 0x1008, Errc::Malformed},
                                                       {0x008, 0xff0, Errc::Malformed},
                                                       {0x008, 0x1010, Errc::Malformed},
                                                       {0x008, 0xfffff000, Errc::Malformed},
                                                       {0x00c, 0x1010, Errc::Malformed},
                                                       {0x00c, 0xffc, Errc::Malformed},
                                                       {0x00c, 16, Errc::Malformed},
                                                       {0x00c, 0, Errc::Malformed},
                                                       {0x010, 0x16010100, Errc::Malformed},
                                                       {0x010, 0x16030101, Errc::Malformed},
                                                       {0x010, 0x16010801, Errc::Malformed},
                                                       {0x010, 0x03010101, Errc::Malformed},
                                                       {0x010, 0x19010101, Errc::Malformed},
                                                       {0x014, 0, Errc::Malformed},
                                                       {0x014, 0xffffffff, Errc::Malformed}}) {
    const auto memory = sound_page();
    EXPECT_TRUE(open(memory));
    memory->words().store(wrong.offset, wrong.word);
    const auto port = open(memory);
    ASSERT_FALSE(port) << wrong.offset << ' ' << wrong.word;
    EXPECT_EQ(port.error().code, wrong.code) << port.error().message;
  }
}

class StrangeBoardTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kResetMeant = 0b1110;  // with the display lengths
  static StepList list() {
    StepListBuilder builder;
    builder.delay(1);
    return builder.finish();
  }
  void say(std::uint32_t offset, std::uint32_t word) { memory_->words().store(offset, word); }
  void add(page::Interrupt which, std::uint32_t count) {
    const std::uint32_t offset = page::kRaised + 4 * static_cast<std::uint32_t>(which);
    say(offset, memory_->words().load(offset) + count);
  }
  void acknowledge() { say(page::kAcknowledge, memory_->words().load(page::kDoorbell)); }
  void beat() { say(page::kBeat, ++beat_); }
  Result<bool> poll() {
    now_ = now_ + milliseconds(1);
    beat();
    return player_.poll(now_);
  }
  void start() { ASSERT_TRUE(player_.start(list(), milliseconds(50), now_)); }
  // Given, and begun.
  void begin() {
    start();
    EXPECT_EQ(poll(), false);
    if (memory_->words().load(page::kMeant) == kResetMeant) {  // the first time
      acknowledge();
      EXPECT_EQ(poll(), false);
    }
    EXPECT_EQ(memory_->words().load(page::kMeant), 1U);
    EXPECT_EQ(memory_->words().load(page::kWritten), 0x10U);
    acknowledge();
    say(page::kRead, 0);
    add(page::Interrupt::NewList, 1);
    EXPECT_EQ(poll(), false);
  }
  void end() {
    say(page::kRead, page::kIsWaiting);
    EXPECT_EQ(poll(), true);
  }
  void expect_strange(const Result<bool>& said) {
    ASSERT_FALSE(said);
    EXPECT_EQ(said.error().code, Errc::Malformed);
    EXPECT_NE(said.error().message.find("what cannot be"), std::string::npos)
        << said.error().message;
    EXPECT_EQ(player_.counters().strange, 1U);
    EXPECT_TRUE(player_.needs_set_up());
    EXPECT_FALSE(player_.is_playing());
    say(page::kRead, page::kIsWaiting);
    begin();  // behind a reset it plays again
    end();
  }

  std::shared_ptr<sim::SimMemory> memory_ = sound_page();
  std::unique_ptr<PciPort> port_ = open(memory_).value();
  ListPlayer player_{*port_, {}};
  MonotonicTime now_{};
  std::uint32_t beat_{0};
};

TEST_F(StrangeBoardTest, ASoundOnePlays) {
  begin();
  end();
  begin();
  end();
  EXPECT_EQ(player_.counters(), (PlayCounters{.started = 2, .done = 2}));
}

// Until it has acknowledged the reset and waits, its descriptors and buffers may be in use: of a
// list that was given up, or of who was here before.
TEST_F(StrangeBoardTest, NothingIsWrittenOverAListThatMayStillRun) {
  const auto is_untouched = [&] {
    for (std::uint32_t at = 0x1000; at < kBytes; at += 4) {
      if (memory_->words().load(at) != 0x5eed) return false;
    }
    return true;
  };
  for (int i = 0; i < 2; ++i) {
    for (std::uint32_t at = 0x1000; at < kBytes; at += 4) say(at, 0x5eed);
    say(page::kRead, 0);  // it runs
    start();
    for (int k = 0; k < 3; ++k) EXPECT_EQ(poll(), false);
    EXPECT_EQ(memory_->words().load(page::kMeant), kResetMeant);
    EXPECT_TRUE(is_untouched()) << "the reset has not been taken";
    acknowledge();
    EXPECT_EQ(poll(), false);
    EXPECT_TRUE(is_untouched()) << "its step is not over";
    say(page::kRead, page::kIsWaiting);
    EXPECT_EQ(poll(), false);
    EXPECT_EQ(memory_->words().load(0x1010), 0x60004000U) << "the delay, ended by a stop";
    EXPECT_EQ(memory_->words().load(page::kMeant), 1U);
    acknowledge();
    say(page::kRead, 0);
    add(page::Interrupt::NewList, 1);
    while (poll()) {  // which it never ends
    }
  }
  EXPECT_EQ(player_.counters().timed_out, 2U);
}

TEST_F(StrangeBoardTest, OneThatFinishesTwice) {
  begin();
  end();
  add(page::Interrupt::NewList, 1);
  start();
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, OneThatRaisesAnInterruptWhileItHasNothingToDo) {
  begin();
  end();
  add(page::Interrupt::Soft, 1);
  start();
  expect_strange(poll());
}

// Its registers are not what the list relies on.
TEST_F(StrangeBoardTest, OneThatStopsBetweenTwoLists) {
  begin();
  end();
  say(page::kRead, page::kIsHalted);
  start();
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, OneThatBeginsTwoListsForOne) {
  begin();
  add(page::Interrupt::NewList, 1);
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, OneWhoseCountsRunBackwards) {
  add(page::Interrupt::Soft, 5);
  begin();
  add(page::Interrupt::Soft, 0xffffffff);
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, OneWithMoreSoftInterruptsThanTheListHas) {
  begin();
  add(page::Interrupt::Soft, 2);
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, OneWithTwoErrorsInAList) {
  begin();
  add(page::Interrupt::Bus, 1);
  add(page::Interrupt::Timeout, 1);
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, OneThatStopsWithoutAReason) {
  begin();
  say(page::kRead, page::kIsHalted);
  expect_strange(poll());
}

TEST_F(StrangeBoardTest, ABusFaultIsTold) {
  begin();
  add(page::Interrupt::Bus, 1);
  say(page::kRead, page::kHasException | page::kIsHalted);
  say(page::kRead + 8, 0x40 | page::kHasBusFault);
  const auto said = poll();
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().code, Errc::Malformed);
  EXPECT_NE(said.error().message.find("at 0x40"), std::string::npos);
  EXPECT_EQ(player_.counters().bus_faults, 1U);
  EXPECT_EQ(player_.counters().strange, 0U);
}

// Whatever a board does not do, the player gives up in time and says what it waited for.
TEST_F(StrangeBoardTest, OneThatNeverComesOn) {
  const std::function<void()> silent = [] {};
  const std::function<void()> acknowledges = [this] { acknowledge(); };
  const std::function<void()> restless = [this] { say(page::kMoment, 1); };
  for (const auto& board : {silent, acknowledges, restless}) {
    start();
    Result<bool> said = false;
    const MonotonicTime end = now_ + milliseconds(50);
    while (said && !*said) {
      ASSERT_LE(now_, end);
      board();
      said = poll();
    }
    EXPECT_EQ(said.error().code, Errc::Timeout);
    EXPECT_FALSE(player_.is_playing());
  }
  EXPECT_EQ(player_.counters().timed_out, 3U);
  EXPECT_EQ(player_.counters().done, 0U);
  EXPECT_GT(port_->counters().restless, 40U);
}

TEST_F(StrangeBoardTest, OneThatTurnsToAllOnes) {
  begin();
  for (std::uint32_t at = 0; at < kBytes; at += 4) say(at, bus::kNobodyAnswers);
  const auto said = poll();
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().code, Errc::Disconnected);
  EXPECT_EQ(port_->why_gone(), Gone::Silent);
}

TEST_F(StrangeBoardTest, CountsAreNotBelievedOfAnotherIncarnation) {
  begin();
  end();
  EXPECT_TRUE(player_.words_of({0x100, 25}, now_));
  say(page::kIncarnation, 8);
  EXPECT_EQ(player_.words_of({0x100, 25}, now_).error().code, Errc::Disconnected);
  EXPECT_EQ(port_->why_gone(), Gone::NewIncarnation);
}

TEST_F(StrangeBoardTest, NobodyRingsTwice) {
  EXPECT_EQ(port_->ring({}, 1), IoStatus::Ok);
  EXPECT_EQ(port_->ring({}, 1), IoStatus::Backlogged);
  acknowledge();
  EXPECT_EQ(port_->ring({}, 1), IoStatus::Ok);
  EXPECT_EQ(port_->counters().held_back, 1U);
  EXPECT_EQ(memory_->words().load(page::kDoorbell), 2U);
}

}  // namespace
}  // namespace thimble::cambus
