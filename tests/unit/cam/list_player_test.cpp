#include "drivers/cambus/list_player.hpp"

#include <gtest/gtest.h>

#include "drivers/cambus/cam_program.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/fault/faulty_memory_window.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"

// The driver's port and the simulated board, with nothing but a window between them.
namespace thimble::cambus {
namespace {

using sim::cam::SimCamBoard;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr BoardShape kShape{{1, 0, 0}, 6};  // two modules of 64 sites
constexpr Duration kPatience = milliseconds(100);

class ListPlayerTest : public testing::Test {
 protected:
  // Polls every 10 us until the list is over.
  Result<bool> play(const StepList& list, Duration at_most = kPatience) {
    const auto started = player_.start(list, at_most, clock_.now());
    if (!started) return tl::unexpected(started.error());
    return wait();
  }
  Result<bool> wait() {
    while (true) {
      const auto is_over = player_.poll(clock_.now());
      if (!is_over || *is_over) return is_over;
      clock_.run_for(microseconds(10));
    }
  }
  StepList set_up() {
    CamProgram program(space_);
    program.number_modules();
    program.set_up();
    return program.finish();
  }
  static StepList delay_of(std::uint32_t clocks) {
    StepListBuilder builder;
    builder.delay(clocks);
    return builder.finish();
  }
  static StepList endless() {
    StepList list = delay_of(100);
    list.bytes[1] = 0x80;  // jump instead of stop
    list.bytes[12] = 0x10;
    return list;
  }
  void expect_set_up_works() {
    const auto is_over = play(set_up());
    ASSERT_TRUE(is_over) << is_over.error().message;
    EXPECT_FALSE(player_.needs_set_up());
  }

  sim::VirtualClock clock_;
  SimCamBoard board_{clock_, {.shape = {{2, 1, 1}, 6}, .window_bytes = 0x10000}};
  std::unique_ptr<PciPort> port_ = PciPort::open(board_.open_window(), clock_.now()).value();
  ListPlayer player_{*port_, {.module_sites = 1U << kShape.log2_sites}};
  CamSpace space_ = CamSpace::make(kShape, {4, 3, 0}, Division::Mesh).value();
};

TEST_F(ListPlayerTest, ThePortKnowsTheBoard) {
  EXPECT_EQ(port_->facts().shape.log2_modules, kShape.log2_modules);
  EXPECT_EQ(port_->facts().shape.log2_sites, kShape.log2_sites);
  EXPECT_EQ(port_->facts().clock_hz, 25'000'000U);
  EXPECT_EQ(port_->facts().window_bytes, 0x10000U);
}

TEST_F(ListPlayerTest, WhatAListReadsComesBack) {
  expect_set_up_works();
  std::vector<std::uint16_t> sites(64);
  for (std::size_t i = 0; i < sites.size(); ++i) sites[i] = static_cast<std::uint16_t>(1000 + i);
  CamProgram program(space_);
  program.write_sites(1, sites);
  const ReadSlot slot = program.read_sites(1);
  const ReadSlot other = program.read_sites(0);
  ASSERT_TRUE(play(program.finish()));
  EXPECT_EQ(player_.words_of(slot, clock_.now()).value(), sites);
  EXPECT_EQ(player_.words_of(other, clock_.now()).value(), std::vector<std::uint16_t>(64));
  EXPECT_EQ(player_.counters(), (PlayCounters{.started = 2, .done = 2}));
}

TEST_F(ListPlayerTest, AListIsOverAsSoonAsItsClocksAreAndNoSooner) {
  expect_set_up_works();
  const MonotonicTime before = clock_.now();
  ASSERT_TRUE(play(delay_of(25'000)));  // 1 ms
  EXPECT_GE(clock_.now() - before, milliseconds(1));
  EXPECT_LE(clock_.now() - before, milliseconds(1) + microseconds(20));
}

TEST_F(ListPlayerTest, OneListAtATimeAndARefusedOneIsNeverSeen) {
  ASSERT_TRUE(player_.start(set_up(), kPatience, clock_.now()));
  EXPECT_EQ(player_.start(delay_of(1), kPatience, clock_.now()).error().code, Errc::Busy);
  ASSERT_TRUE(wait());
  const auto rings = port_->counters().rings;
  StepListBuilder builder;
  builder.write_port(Register::Event, std::vector<std::uint16_t>(kEventBits + 1));
  EXPECT_EQ(play(builder.finish()).error().code, Errc::Malformed);
  StepListBuilder large;
  large.write_port(Register::LutIo, std::vector<std::uint16_t>(kTableEntries, 1));
  std::vector<std::uint16_t> table(kTableEntries);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<std::uint16_t>(i);
  large.write_port(Register::LutIo, table);
  EXPECT_EQ(play(large.finish()).error().code, Errc::TooLarge);
  EXPECT_EQ(port_->counters().rings, rings);
  EXPECT_EQ(player_.counters().refused, 2U);
  EXPECT_FALSE(player_.needs_set_up());
}

TEST_F(ListPlayerTest, ASlotOutsideTheWindowIsRefused) {
  for (const ReadSlot& slot :
       {ReadSlot{0xfff0, 9}, ReadSlot{0x10000, 1}, ReadSlot{0x12, 1}, ReadSlot{16, 0xffffffff}}) {
    EXPECT_EQ(player_.words_of(slot, clock_.now()).error().code, Errc::InvalidArgument);
  }
}

TEST_F(ListPlayerTest, AListThatNeverEndsIsLeftAndTheNextOneStartsBehindAReset) {
  expect_set_up_works();
  const MonotonicTime before = clock_.now();
  const auto is_over = play(endless());
  ASSERT_FALSE(is_over);
  EXPECT_EQ(is_over.error().code, Errc::Timeout);
  EXPECT_NE(is_over.error().message.find("at 0x10"), std::string::npos);
  EXPECT_EQ(clock_.now() - before, kPatience);
  EXPECT_TRUE(player_.needs_set_up());
  EXPECT_EQ(player_.counters().timed_out, 1U);
  expect_set_up_works();
}

TEST_F(ListPlayerTest, AnInterruptOfTheMachineEndsTheList) {
  expect_set_up_works();
  StepListBuilder builder;
  builder.write(
      RegisterWords(Register::IntFlags).set(field::kInterrupts<Register::IntFlags>[7], 1));
  builder.delay(1);
  const auto is_over = play(builder.finish());
  ASSERT_FALSE(is_over);
  EXPECT_EQ(is_over.error().code, Errc::System);
  EXPECT_EQ(player_.counters().machine_interrupts, 1U);
  expect_set_up_works();
}

// Whatever module it is in, and whatever a board with such a defect has enabled.
TEST_F(ListPlayerTest, EachInterruptOfTheMachineIsNamedAndCountedAndTheBoardWorksBehindIt) {
  const auto& flags = field::kInterrupts<Register::IntFlags>;
  RegisterWords all_enabled(Register::IntEnable);
  for (const Field& of : field::kInterrupts<Register::IntEnable>) all_enabled.set(of, 1);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    expect_set_up_works();
    StepListBuilder builder;
    builder.write(all_enabled);
    builder.delay(25'000);  // 1 ms
    builder.write(default_words(Register::Select));
    builder.delay(1);
    ASSERT_TRUE(player_.start(builder.finish(), kPatience, clock_.now()));
    for (int k = 0; k < 50; ++k) {
      ASSERT_EQ(player_.poll(clock_.now()), false);
      clock_.run_for(microseconds(10));
    }
    board_.board().machine().raise(i % 2, i);
    const auto is_over = wait();
    ASSERT_FALSE(is_over) << flags[i].name;
    EXPECT_EQ(is_over.error().code, Errc::System);
    const std::string end = ": " + std::string(flags[i].name);
    const std::string& message = is_over.error().message;
    EXPECT_EQ(message.substr(message.size() - end.size()), end);
    EXPECT_EQ(player_.counters().flags[i], 1U);
    EXPECT_EQ(player_.counters().machine_interrupts, i + 1);
    EXPECT_TRUE(player_.needs_set_up());
  }
  expect_set_up_works();
  EXPECT_EQ(player_.counters().started, 2 * flags.size() + 1);
  EXPECT_EQ(player_.counters().done, flags.size() + 1) << "asking is none of the lists";
}

StepList one_that_interrupts() {
  constexpr std::size_t kRegisterLength = 7;
  StepListBuilder builder;
  builder.write(default_words(Register::Select));
  builder.write(default_words(Register::IntEnable));
  builder.write(RegisterWords(Register::IntFlags)
                    .set(field::kInterrupts<Register::IntFlags>[kRegisterLength], 1));
  builder.delay(1);
  return builder.finish();
}

TEST_F(ListPlayerTest, SeveralFlagsAreNamedAndWhereThereIsNoneItIsSaid) {
  expect_set_up_works();
  const auto& flags = field::kInterrupts<Register::IntFlags>;
  StepListBuilder two;
  two.write(RegisterWords(Register::IntFlags).set(flags[2], 1, 0x0001).set(flags[6], 1, 0x8000));
  const auto both = play(two.finish());
  ASSERT_FALSE(both);
  EXPECT_NE(both.error().message.find(": glue-contention, external"), std::string::npos)
      << both.error().message;
  expect_set_up_works();
  StepListBuilder verify;
  verify.write(RegisterWords(Register::Verify).set(field::kVerify[1], 1).set(field::kVerify[2], 1));
  const auto none = play(verify.finish());
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, Errc::System);
  EXPECT_NE(none.error().message.find("none of its flags"), std::string::npos)
      << none.error().message;
  EXPECT_EQ(player_.counters().machine_interrupts, 2U);
  expect_set_up_works();
}

TEST_F(ListPlayerTest, AMachineThatThereIsNoTimeToAskHasInterruptedAllTheSame) {
  expect_set_up_works();
  const MonotonicTime before = clock_.now();
  const auto is_over = play(one_that_interrupts(), microseconds(10));
  ASSERT_FALSE(is_over);
  EXPECT_EQ(is_over.error().code, Errc::System) << is_over.error().message;
  EXPECT_EQ(clock_.now() - before, microseconds(10));
  EXPECT_EQ(player_.counters().timed_out, 0U);
  EXPECT_EQ(player_.counters().flags, PlayCounters{}.flags);
  expect_set_up_works();
}

TEST_F(ListPlayerTest, AMachineThatIsPulledWhileItIsAskedHasInterruptedAllTheSame) {
  expect_set_up_works();
  ASSERT_TRUE(player_.start(one_that_interrupts(), kPatience, clock_.now()));
  ASSERT_EQ(player_.poll(clock_.now()), false);
  clock_.run_for(microseconds(10));
  ASSERT_EQ(player_.poll(clock_.now()), false) << "it is asked";
  board_.unplug();
  const auto is_over = wait();
  ASSERT_FALSE(is_over);
  EXPECT_EQ(is_over.error().code, Errc::System) << is_over.error().message;
  EXPECT_EQ(player_.start(set_up(), kPatience, clock_.now()).error().code, Errc::Disconnected);
}

TEST_F(ListPlayerTest, AModuleThatDoesNotAnswerEndsTheList) {
  expect_set_up_works();
  StepListBuilder builder;
  builder.write(RegisterWords(Register::Select).set(field::kSelect[1], kTargetOne));  // id 0xffff
  builder.read(Register::Event, kEventBits);
  const auto is_over = play(builder.finish());
  ASSERT_FALSE(is_over);
  EXPECT_EQ(is_over.error().code, Errc::Timeout);
  EXPECT_EQ(player_.counters().module_timeouts, 1U);
  EXPECT_EQ(player_.counters().timed_out, 0U);
  expect_set_up_works();
}

TEST_F(ListPlayerTest, SoftInterruptsOfTheListAreExpected) {
  StepListBuilder builder;
  builder.delay(1);
  builder.raise_interrupt();
  builder.delay(1);
  builder.raise_interrupt();
  EXPECT_TRUE(play(builder.finish()));
  EXPECT_TRUE(play(delay_of(1)));
}

// --- Boards that go away, each during a list.

class GoneTest : public ListPlayerTest {
 protected:
  // What the player says until `within` has passed.
  Error lost(Duration within) {
    const MonotonicTime end = clock_.now() + within;
    while (clock_.now() < end) {
      const auto is_over = player_.poll(clock_.now());
      if (!is_over) return is_over.error();
      clock_.run_for(milliseconds(1));
    }
    return {};
  }
  void expect_lost(Gone why, Duration within) {
    const Error error = lost(within);
    EXPECT_EQ(error.code, Errc::Disconnected);
    EXPECT_NE(error.message.find(to_string(why)), std::string::npos) << error.message;
    EXPECT_EQ(port_->why_gone(), why);
    // For good.
    EXPECT_EQ(player_.start(delay_of(1), kPatience, clock_.now()).error().code, Errc::Disconnected);
    EXPECT_EQ(player_.words_of({16, 1}, clock_.now()).error().code, Errc::Disconnected);
    EXPECT_FALSE(player_.is_playing());
  }
  void SetUp() override {
    ASSERT_TRUE(player_.start(endless(), std::chrono::seconds(10), clock_.now()));
    EXPECT_EQ(lost(milliseconds(5)).code, Error{}.code);
  }
};

TEST_F(GoneTest, Unplugged) {
  board_.unplug();
  expect_lost(Gone::Unplugged, milliseconds(2));
}
TEST_F(GoneTest, ResetByItsPower) {
  board_.power_cycle();
  expect_lost(Gone::NewIncarnation, milliseconds(2));
}
TEST_F(GoneTest, StandingStill) {
  clock_.run_for(milliseconds(50));
  ASSERT_EQ(lost(milliseconds(2)).code, Error{}.code);
  board_.freeze();
  EXPECT_EQ(lost(milliseconds(240)).code, Error{}.code);
  expect_lost(Gone::NoBeat, milliseconds(62));
}

TEST(PciPortOpen, WhatIsNoBoardIsNotMine) {
  auto memory = std::make_shared<sim::SimMemory>(0x2000);
  const auto window = [&] { return std::make_unique<sim::SimMemoryWindow>(memory); };
  EXPECT_EQ(PciPort::open(window(), {}).error().code, Errc::NotMine);
  const auto small = std::make_shared<sim::SimMemory>(0xffc);
  EXPECT_EQ(PciPort::open(std::make_unique<sim::SimMemoryWindow>(small), {}).error().code,
            Errc::NotMine);
  memory->unplug();
  EXPECT_EQ(PciPort::open(window(), {}).error().code, Errc::Disconnected);
}

TEST(PciPortOpen, AHostThatComesLaterGoesOnWithTheDoorbell) {
  sim::VirtualClock clock;
  SimCamBoard board(clock, {.shape = {{1, 1, 1}, 6}, .window_bytes = 0x1000});
  for (int i = 0; i < 3; ++i) {
    const auto port = PciPort::open(board.open_window(), clock.now()).value();
    ListPlayer player(*port, {.module_sites = 64});
    StepListBuilder builder;
    builder.delay(1);
    ASSERT_TRUE(player.start(builder.finish(), kPatience, clock.now()));
    auto is_over = player.poll(clock.now());
    while (is_over && !*is_over) {
      clock.run_for(microseconds(10));
      is_over = player.poll(clock.now());
    }
    EXPECT_TRUE(is_over) << is_over.error().message;
  }
}

// --- A slot that damages what passes: whatever comes, each list is over or failed in its time.

TEST(ListPlayerInABadSlot, NoListOutlastsItsPatience) {
  int boards = 0;
  std::uint64_t done = 0;
  std::uint64_t failed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    sim::VirtualClock clock;
    SimCamBoard board(clock, {.shape = {{1, 1, 1}, 6}, .window_bytes = 0x10000});
    sim::FaultPlan plan;
    plan.seed = seed;
    plan.random = {.drop_in = 0.001,
                   .drop_out = 0.02,
                   .corrupt_in = 0.002,
                   .corrupt_out = 0.02,
                   .truncate_in = 0.001,
                   .truncate_out = 0.02,
                   .stall = 0.0001,
                   .stall_lasts = milliseconds(1)};
    auto port = PciPort::open(
        std::make_unique<sim::FaultyMemoryWindow>(board.open_window(), clock, plan), clock.now());
    if (!port) continue;
    ++boards;
    ListPlayer player(**port, {.module_sites = 64});
    const CamSpace space = CamSpace::make({{0, 0, 0}, 6}, {3, 3, 0}, Division::Mesh).value();
    for (int i = 0; i < 20; ++i) {
      CamProgram program(space);
      program.number_modules();
      program.set_up();
      program.run();
      if (!player.start(program.finish(), milliseconds(5), clock.now())) break;
      const MonotonicTime start = clock.now();
      auto is_over = player.poll(clock.now());
      while (is_over && !*is_over) {
        ASSERT_LE(clock.now() - start, milliseconds(5));
        clock.run_for(microseconds(50));
        is_over = player.poll(clock.now());
      }
      ASSERT_FALSE(player.is_playing());
      ++(is_over ? done : failed);
    }
  }
  EXPECT_GT(boards, 10);
  EXPECT_GT(done, 20U);
  EXPECT_GT(failed, 20U);
}

}  // namespace
}  // namespace thimble::cambus
