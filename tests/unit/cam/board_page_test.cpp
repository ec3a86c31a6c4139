#include "sim/model/cam/board_page.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/cambus/cambus_wire.hpp"
#include "drivers/cambus/register_words.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/unit/cambus/hand_list.hpp"

// The page word by word, without the driver.
namespace thimble::sim::cam {
namespace {

namespace page = cambus::page;
namespace wire = cambus::wire;
using cambus::Register;
using std::chrono::microseconds;
using std::chrono::milliseconds;

class BoardPageTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kEnd = wire::kDelay | wire::kStop;

  std::uint32_t word(std::uint32_t offset) {
    std::uint32_t word = 0;
    EXPECT_EQ(window_->read(offset, word), IoStatus::Ok);
    return word;
  }
  void set(std::uint32_t offset, std::uint32_t value) {
    EXPECT_EQ(window_->write(offset, value), IoStatus::Ok);
  }
  void step_at(std::uint32_t at, std::uint32_t opcode, std::uint32_t buffer, std::uint32_t length,
               std::uint32_t link) {
    const std::array<std::uint32_t, 4> words{opcode, buffer, length, link};
    EXPECT_EQ(window_->write_block(0x1000 + at, words), IoStatus::Ok);
  }
  void ring(std::uint32_t which, std::uint32_t value) {
    set(0x400 + 4 * which, value);
    set(0x410, 1U << which);
    set(0x414, ++rung_);
  }
  std::uint32_t raised(page::Interrupt which) {
    return word(0x814 + 4 * static_cast<std::uint32_t>(which));
  }
  void run_us(int us) { clock_.run_for(microseconds(us)); }

  sim::VirtualClock clock_;
  SimCamBoard board_{clock_,
                     {.shape = {{2, 1, 1}, 6}, .clock_hz = 20'000'000, .window_bytes = 0x400}};
  std::unique_ptr<bus::MemoryWindow> window_ = board_.open_window();
  std::uint32_t rung_{0};
};

TEST_F(BoardPageTest, SaysWhatItIs) {
  EXPECT_EQ(word(0x000), 0x384d4143U);
  EXPECT_EQ(word(0x004), 1U);
  EXPECT_EQ(word(0x008), 0x1000U);
  EXPECT_EQ(word(0x00c), 0x400U);
  EXPECT_EQ(word(0x010), 0x06010102U);
  EXPECT_EQ(word(0x014), 20'000'000U);
  EXPECT_EQ(window_->bytes(), 0x1400U);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsWaiting);
}

TEST_F(BoardPageTest, AnotherIncarnationAfterItsPowerWasCut) {
  const std::uint32_t before = word(0x018);
  ring(0, 0x10);
  board_.power_cycle();
  EXPECT_NE(word(0x018), before);
  EXPECT_EQ(word(0x810), 0U);
  EXPECT_EQ(word(0x414), 0U);
}

TEST_F(BoardPageTest, BeatsUntilItFreezes) {
  std::uint32_t last = word(0x01c);
  for (int i = 0; i < 5; ++i) {
    clock_.run_for(milliseconds(100));
    EXPECT_NE(word(0x01c), last);
    last = word(0x01c);
  }
  board_.freeze();
  clock_.run_for(milliseconds(500));
  EXPECT_EQ(word(0x01c), last);
}

TEST_F(BoardPageTest, AListTakesItsClocks) {
  step_at(0x10, kEnd, 0, 2000, 0);  // 100 us
  ring(0, 0x10);
  EXPECT_EQ(word(0x810), 1U);
  EXPECT_EQ(word(0x800) & 0xfU, 0U) << "it executes";
  EXPECT_EQ(word(0x808) & page::kListPointer, 0x10U);
  EXPECT_EQ(raised(page::Interrupt::NewList), 1U);
  run_us(99);
  EXPECT_EQ(word(0x800) & 0xfU, 0U);
  run_us(1);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsWaiting);
  EXPECT_EQ(word(0x80c) & page::kListPointer, 0x10U);
}

TEST_F(BoardPageTest, OneListWaitsBehindTheOtherAndANewerOneTakesItsPlace) {
  step_at(0x10, kEnd, 0, 2000, 0);
  step_at(0x20, kEnd | wire::kInterrupt, 0, 2000, 0);
  step_at(0x30, kEnd, 0, 2000, 0);
  ring(0, 0x10);
  ring(0, 0x20);
  EXPECT_EQ(word(0x810), 2U);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsListPending);
  ring(0, 0x30);
  run_us(150);
  EXPECT_EQ(word(0x808) & page::kListPointer, 0x30U);
  EXPECT_EQ(word(0x800) & 0xfU, 0U);
  run_us(100);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsWaiting);
  EXPECT_EQ(raised(page::Interrupt::NewList), 2U);
  EXPECT_EQ(raised(page::Interrupt::Soft), 0U);
}

TEST_F(BoardPageTest, ReadingChangesNothing) {
  step_at(0x10, kEnd | wire::kInterrupt, 0, 1, 0);
  ring(0, 0x10);
  run_us(10);
  EXPECT_EQ(raised(page::Interrupt::Soft), 1U);
  EXPECT_EQ(raised(page::Interrupt::Soft), 1U);
  const std::uint32_t moment = word(0x828);
  EXPECT_EQ(moment % 2, 0U);
  run_us(10);
  EXPECT_EQ(word(0x828), moment) << "nothing has changed since";
}

TEST_F(BoardPageTest, AFaultHaltsItAndATimeoutEndsTheListUntilTheExceptionIsCleared) {
  ring(0, 0x400);  // beyond the window
  run_us(1);
  EXPECT_EQ(word(0x800) & 0xfU, page::kHasException | page::kIsHalted);
  EXPECT_EQ(word(0x808) & 0xfU, page::kHasBusFault);
  EXPECT_EQ(raised(page::Interrupt::Bus), 1U);
  step_at(0x10, static_cast<std::uint32_t>(Register::Select) | wire::kImmediate, 0xffff0000, 3,
          0x20);  // a module that is not there
  step_at(0x20, static_cast<std::uint32_t>(Register::SaBit) | wire::kRead, 0x100, 5, 0x30);
  ring(0, 0x10);
  run_us(10);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsListPending | page::kHasException | page::kIsHalted);
  ring(1, page::kClearFault | page::kClearException);
  run_us(10);
  EXPECT_EQ(word(0x800) & 0xfU, page::kHasException | page::kIsWaiting);
  EXPECT_EQ(raised(page::Interrupt::Timeout), 1U);
}

TEST_F(BoardPageTest, TheHostHaltsAndResetsIt) {
  step_at(0x10, wire::kDelay | wire::kJump, 0, 100, 0x10);  // for ever
  ring(0, 0x10);
  clock_.run_for(milliseconds(1));
  EXPECT_EQ(word(0x800) & 0xfU, 0U);
  ring(1, page::kHalt);
  run_us(10);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsHalted);
  ring(1, page::kResetInterface);
  run_us(10);
  EXPECT_EQ(word(0x800) & 0xfU, page::kIsWaiting);
  EXPECT_EQ(raised(page::Interrupt::NewList), 0U);
}

// So that a host that looks seldom does not take one that went round for one that stands still.
TEST_F(BoardPageTest, ItsBeatOnlyCountsUpAndInTime) {
  std::mt19937 random(1);
  std::uint32_t before = word(page::kBeat);
  for (int i = 0; i < 200; ++i) {
    const int ms = static_cast<int>(random() % 1000);
    clock_.run_for(milliseconds(ms));
    const std::uint32_t beats = word(page::kBeat) - before;
    EXPECT_GE(beats, static_cast<std::uint32_t>(ms / page::kBeatAtLeastEvery_ms));
    EXPECT_LE(beats, static_cast<std::uint32_t>(ms) + 1);
    before += beats;
  }
}

TEST_F(BoardPageTest, EnablesAreReadBack) {
  ring(1, 0x1f00 | 1U << 14);
  EXPECT_EQ(word(0x804), 0x1f00U | 1U << 14);
  ring(1, 0x0003 | 1U << 6);
  EXPECT_EQ(word(0x804), 0x1c00U);
}

// Of a line of 100 clocks and a frame of 5 lines: a pulse would have to come.
TEST_F(BoardPageTest, DisplayLengthsStartTheSyncPulsesAndAResetStopsThem) {
  auto& machine = board_.board().machine();
  const auto scan_in_sync = [&] {
    machine.reset();
    machine.write(static_cast<std::uint32_t>(cambus::Register::Select),
                  cambus::default_words(cambus::Register::Select).words());
    machine.write(static_cast<std::uint32_t>(cambus::Register::Run),
                  cambus::RegisterWords(cambus::Register::Run)
                      .set(cambus::field::kSync, cambus::kSyncFrame)
                      .words());
    const bool ends = !machine.hangs();
    machine.wait_for_scan();
    return ends;
  };
  EXPECT_FALSE(scan_in_sync());
  ring(2, 3U << 16 | 60);
  EXPECT_TRUE(scan_in_sync());
  ring(3, 2U << 16 | 40);
  EXPECT_TRUE(scan_in_sync());
  ring(1, page::kResetInterface);
  EXPECT_FALSE(scan_in_sync());
  // Blank lengths alone show no line.
  ring(3, 2U << 16 | 40);
  EXPECT_FALSE(scan_in_sync());
}

// Two million lines of a monitor whose lines take 131,070 clocks each: hours.
TEST_F(BoardPageTest, AResetEndsAStepThatWouldTakeHours) {
  auto& machine = board_.board().machine();
  const std::uint64_t before = machine.now_clocks();
  machine.spend(std::uint64_t{1} << 40);
  clock_.run_for(milliseconds(1));
  ring(1, page::kResetInterface);
  EXPECT_LT(machine.now_clocks() - before, 1'000'000U);
  EXPECT_NE(word(page::kRead) & page::kIsWaiting, 0U);
  machine.hang_for(25'000'000);
  ring(1, page::kResetInterface);
  EXPECT_GT(machine.now_clocks() - before, 25'000'000U) << "a hang outlasts it";
}

TEST(BoardPageFreeRunning, AListIsOverAtOnce) {
  const BoardOptions options{.shape = {{1, 1, 1}, 6}, .window_bytes = 0x400, .is_paced = false};
  SimMemory memory(BoardPage::bytes_of(options));
  BoardPage sut(options, memory.words(), {});
  memory.words().store(0x1010, wire::kDelay | wire::kStop);
  memory.words().store(0x1018, 25'000'000);  // a second
  memory.words().store(0x400, 0x10);
  memory.words().store(0x410, 1);
  memory.words().store(0x414, 1);
  sut.serve({});
  EXPECT_EQ(memory.words().load(0x800) & 0xfU, page::kIsWaiting);
  EXPECT_EQ(sut.machine().now_clocks(), 25'000'000U);
}

// Each look at it takes a while, as each step of a list does.
class BusyThread final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override {
    now_ = now_ + each_;
    return now_;
  }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    now_ = std::max(now_, deadline);
    return {};
  }
  void take(Duration each) noexcept { each_ = each; }

 private:
  mutable MonotonicTime now_{};
  Duration each_{};
};

TEST(BoardPageFreeRunning, ALongListIsPlayedByAndByWhereTheThreadHasOtherThingsToDo) {
  constexpr std::uint32_t kSteps = 20;
  BusyThread thread;
  const BoardOptions options{
      .shape = {{1, 1, 1}, 6}, .window_bytes = 0x400, .is_paced = false, .thread_clock = &thread};
  SimMemory memory(BoardPage::bytes_of(options));
  const bus::SharedWords words = memory.words();
  BoardPage sut(options, words, {});
  for (std::uint32_t i = 1; i <= kSteps; ++i) {
    words.store(0x1000 + 16 * i, i < kSteps ? wire::kDelay : wire::kDelay | wire::kStop);
    words.store(0x1008 + 16 * i, 1000);
    words.store(0x100c + 16 * i, 16 * (i + 1));
  }
  words.store(0x400, 0x10);
  words.store(0x410, 1);
  words.store(0x414, 1);
  thread.take(microseconds(100));
  sut.serve({});
  EXPECT_EQ(sut.machine().now_clocks(), 5000U) << "half a millisecond's";
  EXPECT_EQ(words.load(0x810), 1U) << "the doorbell is taken";
  EXPECT_EQ(words.load(0x800) & 0xfU, 0U);
  thread.take({});
  for (int i = 0; i < 10; ++i) sut.serve({});
  EXPECT_EQ(sut.machine().now_clocks(), 5000U) << "the looks of one turn";
  thread.take(microseconds(100));
  for (int i = 0; i < 3; ++i) sut.serve({});
  EXPECT_EQ(words.load(0x800) & 0xfU, page::kIsWaiting);
  EXPECT_EQ(sut.machine().now_clocks(), 1000U * kSteps) << "and no other clocks";
  EXPECT_EQ(words.load(0x824), 1U) << "one list";
}

}  // namespace
}  // namespace thimble::sim::cam
