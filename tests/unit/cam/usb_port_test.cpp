#include "drivers/cambus/usb_port.hpp"

#include <gtest/gtest.h>

#include <random>

#include "drivers/cambus/board.hpp"
#include "sim/fault/faulty_usb.hpp"
#include "tests/contract/cam_board_oracle.hpp"
#include "tests/support/usb_cam_board.hpp"

// What may happen to a board on USB, and to the cable; what programs do is in
// tests/contract/cam_board_contract.cpp.
namespace thimble::cambus {
namespace {

using sim::cam::SimUsbCamBoard;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr CamGeometry kSpace{{3, 3, 1}, CamDivision::StripY};
const sim::cam::BoardOptions kBoard{
    .shape = {{2, 1, 1}, 6}, .window_bytes = std::size_t{1} << 20, .is_paced = false};

Result<CamAnswer> play(Board& board, const CamSteps& steps, sim::VirtualClock& clock,
                       Duration at_most) {
  const MonotonicTime start = clock.now();
  const auto started = board.start(steps, at_most, clock.now());
  if (!started) return tl::unexpected(started.error());
  while (clock.now() - start <= at_most + milliseconds(1)) {
    auto answer = board.poll(clock.now());
    if (!answer) return tl::unexpected(answer.error());
    if (*answer) return **std::move(answer);
    clock.run_for(microseconds(125));
  }
  ADD_FAILURE() << "the program outlasted its time";
  return fail(Errc::Timeout, "");
}

TEST(UsbPort, AnInterruptOfTheMachineIsNamed) {
  sim::VirtualClock clock;
  SimUsbCamBoard board(clock, kBoard);
  const auto port = test::open_usb_port(board, clock);
  ListPlayer player(*port, {.module_sites = 64});
  const auto& flags = field::kInterrupts<Register::IntFlags>;
  StepListBuilder builder;
  builder.write(default_words(Register::Select));
  builder.write(default_words(Register::IntEnable));
  builder.write(RegisterWords(Register::IntFlags).set(flags[9], 1));
  ASSERT_TRUE(player.start(builder.finish(), std::chrono::seconds(1), clock.now()));
  auto is_over = player.poll(clock.now());
  while (is_over && !*is_over) {
    clock.run_for(microseconds(125));
    is_over = player.poll(clock.now());
  }
  EXPECT_EQ(is_over.error().code, Errc::System);
  EXPECT_NE(is_over.error().message.find(": invalid-sync"), std::string::npos)
      << is_over.error().message;
  EXPECT_EQ(player.counters().flags[9], 1U);
}

TEST(UsbBoardMatch, ABoardIsKnownByItsNameAndItsPipes) {
  sim::VirtualClock clock;
  const bus::BusDeviceInfo info = SimUsbCamBoard(clock, kBoard).info();
  EXPECT_EQ(match_usb_board(info).value().packet_bytes, 64U);
  auto fast = info;
  for (auto& endpoint : fast.endpoints) endpoint.max_packet_bytes = 512;
  EXPECT_EQ(match_usb_board(fast).value().packet_bytes, 512U);

  auto other = info;
  other.product = "CAM-8";
  EXPECT_EQ(match_usb_board(other).error().code, Errc::NotMine);
  other = info;
  other.kind = bus::BusKind::Hid;
  EXPECT_EQ(match_usb_board(other).error().code, Errc::NotMine);
  for (std::size_t i = 0; i < 2; ++i) {
    other = info;
    other.endpoints[i].kind = bus::UsbTransferKind::Interrupt;
    EXPECT_EQ(match_usb_board(other).error().code, Errc::NotMine);
    other.endpoints[i] = info.endpoints[i];
    other.endpoints[i].max_packet_bytes = 32;
    EXPECT_EQ(match_usb_board(other).error().code, Errc::NotMine);
  }
}

class UsbPortTest : public testing::Test {
 protected:
  // Until it says more than that it is on its way, or for so long.
  IoStatus poll(Duration at_most = milliseconds(5)) {
    const MonotonicTime start = clock_.now();
    IoStatus status = port_->poll(clock_.now(), status_);
    while (status == IoStatus::NoData && clock_.now() - start < at_most) {
      clock_.run_for(microseconds(125));
      status = port_->poll(clock_.now(), status_);
    }
    return status;
  }
  IoStatus poll_for(Duration time) {
    const MonotonicTime start = clock_.now();
    IoStatus status = IoStatus::Ok;
    while (status != IoStatus::Disconnected && clock_.now() - start < time) {
      clock_.run_for(milliseconds(1));
      status = port_->poll(clock_.now(), status_);
    }
    return status;
  }
  IoStatus get(std::uint32_t offset, std::span<std::uint8_t> bytes) {
    IoStatus status = port_->get(offset, bytes);
    for (int i = 0; i < 5000 && status == IoStatus::NoData; ++i) {
      clock_.run_for(microseconds(125));
      static_cast<void>(port_->poll(clock_.now(), status_));
      status = port_->get(offset, bytes);
    }
    return status;
  }

  sim::VirtualClock clock_;
  SimUsbCamBoard board_{clock_, kBoard};
  std::unique_ptr<UsbPort> port_ = test::open_usb_port(board_, clock_);
  BoardStatus status_;
};

TEST_F(UsbPortTest, WhatIsPutIsGot) {
  std::mt19937 random(5);
  for (const std::size_t size : {4U, 44U, 48U, 52U, 4080U, 4096U, 4100U, 100'000U}) {
    std::vector<std::uint8_t> put(size);
    for (auto& byte : put) byte = static_cast<std::uint8_t>(random());
    ASSERT_EQ(poll(), IoStatus::Ok);
    ASSERT_EQ(port_->put(0x40, put), IoStatus::Ok);
    std::vector<std::uint8_t> got(size);
    ASSERT_EQ(get(0x40, got), IoStatus::Ok);
    EXPECT_EQ(got, put) << size;
  }
  EXPECT_EQ(port_->bytes_per_s(), 1'024'000U) << "at full speed";
  EXPECT_EQ(port_->link().restarts, 0U);
  EXPECT_EQ(board_.model().counters().malformed, 0U);
}

TEST_F(UsbPortTest, WhatWasAskedForBeforeAPutIsNotHandedOverAfterIt) {
  std::array<std::uint8_t, 8> got{};
  ASSERT_EQ(port_->get(0x40, got), IoStatus::NoData);
  clock_.run_for(milliseconds(5));
  const std::array<std::uint8_t, 8> put{1, 2, 3, 4, 5, 6, 7, 8};
  ASSERT_EQ(port_->put(0x40, put), IoStatus::Ok);
  ASSERT_EQ(get(0x40, got), IoStatus::Ok);
  EXPECT_EQ(got, put);
}

TEST_F(UsbPortTest, WhatDoesNotLieInTheWindowIsRefused) {
  std::array<std::uint8_t, 8> bytes{};
  const auto end = std::uint32_t{1} << 20;
  for (const std::uint32_t offset : {end - 4, end, 0xfffffffcU, 2U}) {
    EXPECT_EQ(port_->put(offset, bytes), IoStatus::ProtocolError);
    EXPECT_EQ(port_->get(offset, bytes), IoStatus::ProtocolError);
  }
  EXPECT_EQ(port_->put(0, std::span(bytes).first(3)), IoStatus::ProtocolError);
}

TEST_F(UsbPortTest, NobodyRingsTwice) {
  EXPECT_EQ(port_->ring({}, 0), IoStatus::Backlogged) << "nothing has been seen";
  ASSERT_EQ(poll(), IoStatus::Ok);
  EXPECT_EQ(port_->ring({}, 0), IoStatus::Ok);
  EXPECT_EQ(port_->ring({}, 0), IoStatus::Backlogged);
  ASSERT_EQ(poll(), IoStatus::Ok);
  EXPECT_TRUE(port_->is_taken(status_));
  EXPECT_EQ(port_->ring({}, 0), IoStatus::Ok);
  EXPECT_EQ(port_->counters().held_back, 2U);
}

TEST_F(UsbPortTest, Unplugged) {
  ASSERT_EQ(poll(), IoStatus::Ok);
  board_.unplug();
  EXPECT_EQ(poll(), IoStatus::Disconnected);
  EXPECT_EQ(port_->why_gone(), Gone::Unplugged);
  board_.replug();
  EXPECT_EQ(poll(), IoStatus::Disconnected);
  std::array<std::uint8_t, 4> bytes{};
  EXPECT_EQ(port_->put(0, bytes), IoStatus::Disconnected);
  EXPECT_EQ(port_->get(0, bytes), IoStatus::Disconnected);
  EXPECT_EQ(port_->ring({}, 1), IoStatus::Disconnected);
  EXPECT_EQ(port_->confirm(clock_.now()), IoStatus::Disconnected);
  const std::uint32_t before = port_->facts().incarnation;
  port_.reset();
  EXPECT_NE(test::open_usb_port(board_, clock_)->facts().incarnation, before);
}

TEST_F(UsbPortTest, StandingStill) {
  EXPECT_EQ(poll_for(milliseconds(500)), IoStatus::Ok);
  board_.freeze();
  EXPECT_NE(poll_for(milliseconds(240)), IoStatus::Disconnected);
  EXPECT_EQ(poll_for(milliseconds(100)), IoStatus::Disconnected);
  EXPECT_EQ(port_->why_gone(), Gone::NoBeat);
}

TEST_F(UsbPortTest, NotLookedAtForLongItIsStillThere) {
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(poll(), IoStatus::Ok);
    clock_.run_for(std::chrono::seconds(10));
  }
  EXPECT_EQ(port_->link().restarts, 0U);
}

// --- A cable that spoils what passes.

std::unique_ptr<bus::UsbDevice> behind_cable(SimUsbCamBoard& board, const sim::VirtualClock& clock,
                                             const sim::FaultPlan& plan) {
  const UsbBoardMatch match = match_usb_board(board.info()).value();
  const auto pipes = bus::resolve_claim(match.claim, board.info().endpoints).value();
  return std::make_unique<sim::FaultyUsb>(board.open(match.claim).value(), pipes, clock, plan);
}
Result<std::unique_ptr<UsbPort>> open_behind_cable(SimUsbCamBoard& board, sim::VirtualClock& clock,
                                                   const sim::FaultPlan& plan) {
  return test::wait_for_board(
      {behind_cable(board, clock, plan), match_usb_board(board.info()).value()}, clock);
}

sim::FaultPlan always(sim::FaultKind kind, MonotonicTime from = {}) {
  sim::FaultPlan plan;
  plan.script.push_back({.kind = kind, .from = from});
  return plan;
}

TEST(UsbPortBehindABadCable, SilenceIsGivenUp) {
  sim::VirtualClock clock;
  SimUsbCamBoard board(clock, kBoard);
  const MonotonicTime end{milliseconds(100)};
  auto port = open_behind_cable(board, clock, always(sim::FaultKind::DropIn, end)).value();
  clock.sleep_until(end);
  BoardStatus status;
  MonotonicTime gone_at{};
  while (port->poll(clock.now(), status) != IoStatus::Disconnected) {
    ASSERT_LT(clock.now() - end, std::chrono::seconds(1));
    clock.run_for(milliseconds(1));
    gone_at = clock.now();
  }
  EXPECT_EQ(port->why_gone(), Gone::Silent);
  EXPECT_GE(gone_at - end, milliseconds(290));
  EXPECT_GE(port->link().late, 4U);
}

TEST(UsbPortBehindABadCable, WhoeverNeverAnswersIsNoBoard) {
  sim::VirtualClock clock;
  SimUsbCamBoard board(clock, kBoard);
  for (const auto kind : {sim::FaultKind::DropIn, sim::FaultKind::DropOut, sim::FaultKind::Halt,
                          sim::FaultKind::Stall, sim::FaultKind::CorruptIn}) {
    const auto port = open_behind_cable(board, clock, always(kind));
    ASSERT_FALSE(port);
    EXPECT_EQ(port.error().code, Errc::NotMine) << port.error().message;
  }
}

TEST(UsbPortBehindABadCable, AStallCostsARoundTrip) {
  sim::VirtualClock clock;
  SimUsbCamBoard board(clock, kBoard);
  sim::FaultPlan plan;
  plan.script = {
      {.kind = sim::FaultKind::Halt, .first_report = 20, .reports = 1, .endpoint = 1},
      {.kind = sim::FaultKind::Halt, .first_report = 40, .reports = 1, .endpoint = 0x81}};
  Board sut(open_behind_cable(board, clock, plan).value());
  test::CamBoardOracle oracle(kSpace);
  std::mt19937 random(2);
  ASSERT_TRUE(sut.lay_out(kSpace));
  ASSERT_TRUE(play(sut, oracle.first_program(random), clock, milliseconds(800)));
  const auto& link = static_cast<const UsbPort&>(sut.port()).link();
  EXPECT_EQ(link.restarts, 2U);
  EXPECT_EQ(link.late, 0U);
}

// Whatever is lost, spoilt, cut, late or refused: a program is over or has failed in its time, and
// what it says is right.
TEST(UsbPortBehindABadCable, NoProgramOutlastsItsTimeAndNoAnswerIsWrong) {
  std::uint64_t done = 0;
  std::uint64_t failed = 0;
  std::uint64_t restarts = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    sim::VirtualClock clock;
    SimUsbCamBoard board(clock, kBoard);
    std::mt19937 random(static_cast<unsigned>(seed));
    const double chance = seed % 4 == 0 ? 0.01 : 0.0005;
    sim::FaultPlan plan;
    plan.seed = seed;
    plan.random = {.drop_in = chance,
                   .drop_out = chance,
                   .delay_in = chance,
                   .delay_out = chance,
                   .corrupt_in = chance,
                   .corrupt_out = chance,
                   .truncate_in = chance,
                   .truncate_out = chance,
                   .stall = chance / 10,
                   .halt = chance,
                   .babble = chance,
                   .max_delay = milliseconds(5),
                   .stall_lasts = milliseconds(70)};
    auto port = open_behind_cable(board, clock, plan);
    if (!port) continue;
    Board sut(*std::move(port));
    test::CamBoardOracle oracle(kSpace);
    for (int i = 0; i < 8; ++i) {
      const bool is_first = sut.needs_lay_out();
      if (is_first) {
        ASSERT_TRUE(sut.lay_out(kSpace));
        oracle = test::CamBoardOracle(kSpace);
      }
      const CamSteps steps =
          is_first ? oracle.first_program(random) : test::random_steps(random, kSpace);
      const auto answer = play(sut, steps, clock, std::chrono::seconds(2));
      ++(answer ? done : failed);
      if (!answer || is_first) continue;
      const CamAnswer expected = oracle.play(steps);
      ASSERT_EQ(answer->counts, expected.counts) << seed << ' ' << i;
      ASSERT_EQ(answer->cells, expected.cells) << seed << ' ' << i;
    }
    restarts += static_cast<const UsbPort&>(sut.port()).link().restarts;
  }
  EXPECT_GT(done, 50U);
  EXPECT_GT(failed, 0U);
  EXPECT_GT(restarts, 100U);
}

}  // namespace
}  // namespace thimble::cambus
