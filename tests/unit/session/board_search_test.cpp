#include "daemon/session/board_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "daemon/session/cam_boards.hpp"
#include "sim/bus/sim_enumerator.hpp"
#include "sim/model/cam/cam_usb_model.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/support/postponed_executor.hpp"

namespace thimble::session {
namespace {

const sim::cam::BoardOptions kBoard{.shape = {{1, 1, 1}, 16}, .window_bytes = 1 << 16};
const bus::DeviceAddress kFirst{"usb:1-1"};
const bus::DeviceAddress kSecond{"usb:1-2"};

struct BoardSearchTest : testing::Test {
  sim::VirtualClock clock;
  sim::SimEnumerator buses{clock};
  test::PostponedExecutor work;
  std::optional<BoardSearch> sut{std::in_place, BoardPlugs{&buses, &work}};

  void plug(const bus::DeviceAddress& address) {
    EXPECT_TRUE(buses.plug(address, std::make_unique<sim::cam::CamUsbModel>(kBoard)));
  }
  Result<ClaimedBoard> take() { return sut->take(clock.now()); }
  Result<ClaimedBoard> find() {
    static_cast<void>(take());
    work.do_all();
    return take();
  }
  bool is_open(const bus::DeviceAddress& address) {
    const auto match = cambus::match_usb_board(buses.list().front());
    const auto other = buses.open_usb(address, match->claim);
    return !other && other.error().code == Errc::Busy;
  }
};

TEST_F(BoardSearchTest, GivesABoardWhenItHasBeenOpenedAndNotBefore) {
  plug(kFirst);
  EXPECT_EQ(take().error().code, Errc::Busy);
  EXPECT_EQ(take().error().code, Errc::Busy);
  EXPECT_EQ(work.waiting(), 1U) << "one search at a time";
  EXPECT_FALSE(is_open(kFirst)) << "nobody waits for it";
  work.do_all();
  const auto board = take();
  ASSERT_TRUE(board) << board.error().message;
  EXPECT_EQ(board->match.packet_bytes, 64U);
  EXPECT_TRUE(is_open(kFirst));
}

TEST_F(BoardSearchTest, WhatItGaveIsClosedByTheWork) {
  plug(kFirst);
  auto board = find();
  ASSERT_TRUE(board);
  sut.reset();
  board->device.reset();
  EXPECT_TRUE(is_open(kFirst)) << "here nothing is closed";
  work.do_all();
  EXPECT_FALSE(is_open(kFirst));
}

TEST_F(BoardSearchTest, WhatNobodyTookIsClosedByTheWork) {
  plug(kFirst);
  for (const bool is_done : {true, false}) {
    sut.emplace(BoardPlugs{&buses, &work});
    static_cast<void>(take());
    if (is_done) work.do_all();
    sut.reset();
    EXPECT_EQ(is_open(kFirst), is_done);
    work.do_all();
    EXPECT_FALSE(is_open(kFirst)) << is_done;
  }
}

TEST_F(BoardSearchTest, TakesTheNextBoardWhereOneIsSomebodyElses) {
  plug(kFirst);
  plug(kSecond);
  const auto first = find();
  ASSERT_TRUE(first);
  sut->note_works();
  const auto second = find();
  ASSERT_TRUE(second) << second.error().message;
  sut->note_works();
  const auto third = find();
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, Errc::Busy);
  EXPECT_THAT(third.error().message, testing::StartsWith(kFirst.text));
}

TEST_F(BoardSearchTest, LooksLessOftenWhileThereIsNone) {
  EXPECT_EQ(find().error().code, Errc::NotFound);
  int looks = 0;
  for (int i = 0; i < 100; ++i) {
    clock.run_for(std::chrono::milliseconds(100));
    const auto none = take();
    EXPECT_FALSE(none);
    looks += static_cast<int>(work.waiting());
    work.do_all();
  }
  EXPECT_GT(looks, 4);
  EXPECT_LT(looks, 15);
  plug(kFirst);
  clock.run_for(RetryPace::kLongest);
  EXPECT_TRUE(find());
}

// As a world does that finds no use for it.
TEST_F(BoardSearchTest, TakesTheOneThatNeverWorkedLast) {
  const bus::DeviceAddress third{"usb:1-3"};
  for (const auto& address : {kFirst, kSecond, third}) plug(address);
  const auto take_after_a_while = [&] {
    clock.run_for(RetryPace::kLongest);
    return find().value().address.text;  // and drops it
  };
  const auto next = [&] {
    const std::string address = take_after_a_while();
    work.do_all();
    return address;
  };
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(next(), kFirst.text);
    EXPECT_EQ(next(), kSecond.text);
    EXPECT_EQ(next(), third.text);
  }
  EXPECT_EQ(next(), kFirst.text);
  sut->note_works();
  EXPECT_EQ(next(), kFirst.text) << "the only one that ever worked";
}

TEST_F(BoardSearchTest, OneThatNeverWorksIsTakenLessAndLessOften) {
  plug(kFirst);
  int takes = 0;
  for (int i = 0; i < 100; ++i) {
    clock.run_for(std::chrono::milliseconds(100));
    takes += find() ? 1 : 0;
    work.do_all();
  }
  EXPECT_GT(takes, 4);
  EXPECT_LT(takes, 15);
}

// Each step of it, the way a world goes.
TEST_F(BoardSearchTest, AWorldOpensItPulledOutAndPluggedInAgain) {
  const auto opener = open_plugged_in({&buses, &work});
  const auto open = [&] {
    auto board = opener(clock.now());
    for (int i = 0; i < 1000 && !board; ++i) {
      work.do_all();
      clock.run_for(std::chrono::milliseconds(5));
      board = opener(clock.now());
    }
    return board;
  };
  EXPECT_EQ(open().error().code, Errc::NotFound);
  plug(kFirst);
  for (int i = 0; i < 3; ++i) {
    auto board = open();
    ASSERT_TRUE(board) << board.error().message;
    EXPECT_EQ((*board)->info().modules, 1);
    ASSERT_TRUE(buses.unplug(kFirst));
    board->reset();
    EXPECT_EQ(open().error().code, Errc::NotFound);
    ASSERT_TRUE(buses.replug(kFirst));
  }
}

// One in a slot, whose memory is opened elsewhere.
struct BoardInARealSlot : testing::Test {
  sim::VirtualClock clock;
  sim::cam::SimCamBoard slot{clock, kBoard};
  test::PostponedExecutor work;
  int openings{0};
  Result<void> refusal;
  world::cam::PieceBoard::Opener sut =
      open_in_real_slot({nullptr, &work, [this]() -> Result<std::unique_ptr<bus::MemoryWindow>> {
                           ++openings;
                           if (!refusal) return tl::unexpected(refusal.error());
                           return slot.open_window();
                         }});
};

TEST_F(BoardInARealSlot, IsOpenWhenItsMemoryIsAndNobodyWaits) {
  EXPECT_EQ(sut(clock.now()).error().code, Errc::Busy);
  EXPECT_EQ(sut(clock.now()).error().code, Errc::Busy);
  EXPECT_EQ(work.waiting(), 1U);
  EXPECT_EQ(openings, 0);
  work.do_all();
  const auto board = sut(clock.now());
  ASSERT_TRUE(board) << board.error().message;
  EXPECT_EQ((*board)->info().modules, 1);
}

TEST_F(BoardInARealSlot, ThatIsRefusedIsAskedForAgainAndSaysWhy) {
  refusal = fail(Errc::NotFound, "no helper");
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(sut(clock.now()));
    work.do_all();
    clock.run_for(std::chrono::milliseconds(100));
  }
  EXPECT_GT(openings, 4);
  EXPECT_LT(openings, 15);
  EXPECT_EQ(sut(clock.now()).error().message, "no helper");
  refusal = {};
  clock.run_for(RetryPace::kLongest);
  EXPECT_FALSE(sut(clock.now()));
  work.do_all();
  EXPECT_TRUE(sut(clock.now()));
}

TEST_F(BoardInARealSlot, MemoryThatNobodyTookIsGivenBackByTheWork) {
  EXPECT_FALSE(sut(clock.now()));
  sut = nullptr;
  EXPECT_EQ(work.waiting(), 2U);
  work.do_all();
  EXPECT_EQ(openings, 1);
}

}  // namespace
}  // namespace thimble::session
