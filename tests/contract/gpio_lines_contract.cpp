#include <atomic>
#include <random>
#include <vector>

#include "tests/contract/gpio_rig.hpp"

namespace thimble::test {
namespace {

using std::chrono::milliseconds;

struct CountingWake final : rt::WakeSignal {
  std::atomic<int> signals{0};  // of the bus's thread
  void signal() noexcept override { ++signals; }
};

std::vector<bus::GpioEdge> take_edges(bus::GpioLines& lines) {
  std::vector<bus::GpioEdge> edges;
  bus::GpioEdge edge;
  while (lines.next_edge(edge) == IoStatus::Ok) edges.push_back(edge);
  return edges;
}

bus::GpioLevels levels_of(bus::GpioLines& lines) {
  bus::GpioLevels levels;
  EXPECT_EQ(lines.levels(levels), IoStatus::Ok);
  return levels;
}

}  // namespace

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GpioLinesContract);

void GpioLinesContract::expect_gone(bus::GpioLines& lines) {
  bus::GpioEdge edge;
  bus::GpioLevels levels;
  EXPECT_EQ(lines.next_edge(edge), IoStatus::Disconnected);
  EXPECT_EQ(lines.levels(levels), IoStatus::Disconnected);
  EXPECT_EQ(lines.set(0, true), IoStatus::Disconnected);
}

TEST_P(GpioLinesContract, TheLevelsAreThereAsSoonAsItIsOpenAndNoEdgeIs) {
  rig->set_wire(2, true);
  const auto sut = open();
  EXPECT_FALSE(levels_of(*sut).is_high(0));
  EXPECT_TRUE(levels_of(*sut).is_high(1));
  EXPECT_TRUE(take_edges(*sut).empty());
}

TEST_P(GpioLinesContract, EachEdgeIsToldOnceInOrderWithItsNumberAndTime) {
  const auto sut = open();
  std::vector<bus::GpioEdge> expected;
  for (std::uint64_t i = 1; i <= 20; ++i) {
    rig->run_for(milliseconds(5));
    const bool is_high = i % 2 != 0;
    expected.push_back({1, is_high, rig->now(), i});
    rig->set_wire(2, is_high);
    if (i % 5 != 0) continue;
    expected.push_back({0, i % 10 != 0, rig->now(), i / 5});
    rig->set_wire(0, i % 10 != 0);
  }
  settle();
  const std::vector<bus::GpioEdge> edges = take_edges(*sut);
  ASSERT_EQ(edges.size(), expected.size());
  for (const int input : {0, 1}) {
    std::vector<bus::GpioEdge> mine;
    std::vector<bus::GpioEdge> wanted;
    const auto is_mine = [input](const bus::GpioEdge& edge) { return edge.input == input; };
    std::copy_if(edges.begin(), edges.end(), std::back_inserter(mine), is_mine);
    std::copy_if(expected.begin(), expected.end(), std::back_inserter(wanted), is_mine);
    ASSERT_EQ(mine.size(), wanted.size());
    for (std::size_t i = 0; i < mine.size(); ++i) {
      EXPECT_EQ(mine[i].sequence, wanted[i].sequence);
      EXPECT_EQ(mine[i].is_high, wanted[i].is_high);
      EXPECT_GE(mine[i].arrived_at, wanted[i].arrived_at);
      EXPECT_LE(mine[i].arrived_at - wanted[i].arrived_at, rig->limits().slowest_edge);
    }
  }
  EXPECT_TRUE(take_edges(*sut).empty());
}

TEST_P(GpioLinesContract, WiresThatNobodyAskedForAreNotTold) {
  const auto sut = open();
  rig->set_wire(1, true);
  rig->set_wire(7, true);
  settle();
  EXPECT_TRUE(take_edges(*sut).empty());
  EXPECT_EQ(levels_of(*sut).high, 0U);
}

TEST_P(GpioLinesContract, TheLevelsFollowTheWiresAndAreNeverOld) {
  const auto sut = open();
  for (int i = 0; i < 50; ++i) {
    rig->set_wire(0, i % 3 == 0);
    settle();
    EXPECT_EQ(levels_of(*sut).is_high(0), i % 3 == 0) << i;
    EXPECT_LE(rig->now() - levels_of(*sut).read_at, 2 * bus::kGpioReadPeriod) << i;
  }
}

TEST_P(GpioLinesContract, OutputsAreLowUntilTheyAreSetAndLowAgainWhenItIsClosed) {
  auto sut = open();
  for (const std::size_t line : kOutputLines) EXPECT_FALSE(rig->wire(line));
  EXPECT_EQ(sut->set(1, true), IoStatus::Ok);
  settle();
  EXPECT_FALSE(rig->wire(4));
  EXPECT_TRUE(rig->wire(5));
  EXPECT_EQ(sut->set(0, true), IoStatus::Ok);
  EXPECT_EQ(sut->set(2, true), IoStatus::ProtocolError) << "there are two";
  settle();
  EXPECT_TRUE(rig->wire(4));
  EXPECT_TRUE(rig->wire(5)) << "one does not touch the other";
  sut.reset();
  for (const std::size_t line : kOutputLines) EXPECT_FALSE(rig->wire(line));
}

TEST_P(GpioLinesContract, ALostEdgeLeavesAHoleInTheNumbers) {
  if (const char* why = rig->limits().why_no_edge_is_lost) GTEST_SKIP() << why;
  const auto sut = open();
  rig->set_wire(0, true);
  settle();
  rig->lose_edges(1);
  rig->set_wire(0, false);
  settle();
  rig->set_wire(0, true);
  settle();
  const auto edges = take_edges(*sut);
  ASSERT_EQ(edges.size(), 2U);
  EXPECT_EQ(edges[0].sequence, 1U);
  EXPECT_EQ(edges[1].sequence, 3U);
}

TEST_P(GpioLinesContract, TheLevelTellsWhatALostEdgeDidNot) {
  if (const char* why = rig->limits().why_no_edge_is_lost) GTEST_SKIP() << why;
  const auto sut = open();
  rig->lose_edges(1);
  rig->set_wire(0, true);
  settle();
  EXPECT_TRUE(take_edges(*sut).empty());
  EXPECT_TRUE(levels_of(*sut).is_high(0));
}

TEST_P(GpioLinesContract, EdgesThatNobodyTakesAreMissedOnce) {
  const auto sut = open();
  for (int i = 0; i < 300; ++i) {
    rig->set_wire(0, i % 2 == 0);
    rig->run_for(bus::kGpioReadPeriod);
  }
  const auto edges = take_edges(*sut);  // ends with ProtocolError
  EXPECT_EQ(edges.size(), 256U);
  bus::GpioEdge edge;
  EXPECT_EQ(sut->next_edge(edge), IoStatus::NoData);
  rig->set_wire(0, true);
  settle();
  EXPECT_GT(take_edges(*sut).front().sequence, 257U);
}

TEST_P(GpioLinesContract, AChipThatIsPulledOutIsGoneForItsLinesAndCanBeOpenedWhenItIsBack) {
  if (const char* why = rig->limits().why_it_stays) GTEST_SKIP() << why;
  const auto sut = open();
  EXPECT_EQ(sut->set(0, true), IoStatus::Ok);
  settle();
  rig->lose_chip();
  settle();
  expect_gone(*sut);
  EXPECT_EQ(rig->open(claim(), nullptr).error().code, Errc::NotFound);
  EXPECT_FALSE(rig->wire(4));
  rig->restore_chip();
  settle();
  expect_gone(*sut);
  const auto second = open();
  EXPECT_EQ(second->set(0, true), IoStatus::Ok);
  settle();
  EXPECT_TRUE(rig->wire(4));
}

TEST_P(GpioLinesContract, ALineThatIsTakenAwayTakesTheOthersWithIt) {
  if (const char* why = rig->limits().why_no_line_goes_alone) GTEST_SKIP() << why;
  const auto sut = open();
  rig->lose_line(2);
  settle();
  expect_gone(*sut);
}

void GpioLinesContract::expect_age_and_backlog(void (GpioRig::*mute)(bool)) {
  if (const char* why = rig->limits().why_it_always_answers) GTEST_SKIP() << why;
  const auto sut = open();
  (*rig.*mute)(true);
  EXPECT_EQ(sut->set(0, true), IoStatus::Ok);
  rig->run_for(milliseconds(200));
  EXPECT_EQ(sut->set(0, true), IoStatus::Backlogged);
  EXPECT_GE(rig->now() - levels_of(*sut).read_at, milliseconds(199));
  (*rig.*mute)(false);
  EXPECT_EQ(sut->set(0, true), IoStatus::Backlogged);
  settle();
  EXPECT_EQ(sut->set(0, true), IoStatus::Ok);
  EXPECT_LE(rig->now() - levels_of(*sut).read_at, 2 * bus::kGpioReadPeriod);
  EXPECT_TRUE(rig->wire(4));
}

TEST_P(GpioLinesContract, AChipThatAnswersNothingShowsInItsAgeAndInItsOutputs) {
  expect_age_and_backlog(&GpioRig::hang);
}

TEST_P(GpioLinesContract, SoDoesOneThatRefusesWhatItIsAskedFor) {
  expect_age_and_backlog(&GpioRig::refuse);
}

TEST_P(GpioLinesContract, AnEdgeAndAnotherLevelWakeAndTheSameLevelDoesNot) {
  CountingWake wake;
  const auto sut = rig->open(claim(), &wake).value();
  settle();
  const int before = wake.signals.load();
  settle();
  EXPECT_EQ(wake.signals.load(), before);
  rig->set_wire(0, true);
  settle();
  EXPECT_GT(wake.signals.load(), before);
}

TEST_P(GpioLinesContract, RefusalsHaveTheirCauses) {
  const auto refusal = [&](const bus::GpioClaim& claim) {
    const auto opened = rig->open(claim, nullptr);
    EXPECT_FALSE(opened.has_value());
    return opened ? Errc::System : opened.error().code;
  };
  const std::string chip = rig->label();
  const std::string line_5 = rig->name_of_line_5();
  EXPECT_EQ(refusal({chip + "2", {"0"}, {}}), Errc::NotFound);
  EXPECT_EQ(refusal({chip, {"8"}, {}}), Errc::NotFound);
  EXPECT_EQ(refusal({chip, {"ESTOP-B"}, {}}), Errc::NotFound);
  EXPECT_EQ(refusal({chip, {}, {line_5, "LAMP"}}), Errc::NotFound);
  EXPECT_EQ(refusal({chip, {}, {}}), Errc::InvalidArgument);
  EXPECT_EQ(refusal({"", {"0"}, {}}), Errc::InvalidArgument);
  EXPECT_EQ(refusal({chip, {"0"}, {"0"}}), Errc::InvalidArgument);
  EXPECT_EQ(refusal({chip, std::vector<std::string>(9, "0"), {}}), Errc::InvalidArgument);
  {
    const auto holder = open();
    EXPECT_EQ(refusal({chip, {"2"}, {}}), Errc::Busy);
    EXPECT_EQ(refusal({chip, {}, {line_5}}), Errc::Busy);
    EXPECT_TRUE(rig->open({chip, {"1"}, {"7"}}, nullptr).has_value()) << "others are free";
  }
  EXPECT_NE(open(), nullptr) << "nothing is left behind";
}

// Against what a list of the wires' changes says.
TEST_P(GpioLinesContract, WhateverHappensOnTheWiresIsToldOrMissed) {
  const unsigned lives = rig->limits().random_lives;
  for (unsigned seed = 1; seed <= lives; ++seed) {
    rig.reset();  // two chips of one label would be none
    rig = GetParam().make();
    std::mt19937 dice(seed);
    const auto sut = open();
    std::array<bool, 2> wires{};
    std::array<std::uint64_t, 2> told{};
    std::array<bool, 2> outputs{};
    for (int step = 0; step < 300; ++step) {
      const std::size_t which = dice() % 2;
      switch (dice() % 4) {
        case 0:
          rig->set_wire(kInputLines.at(which), wires.at(which) = !wires.at(which));
          break;
        case 1:
          EXPECT_EQ(sut->set(which, outputs.at(which) = dice() % 2 != 0), IoStatus::Ok);
          break;
        default:
          break;
      }
      settle();
      for (const bus::GpioEdge& edge : take_edges(*sut)) {
        EXPECT_EQ(edge.sequence, ++told.at(edge.input));
        EXPECT_EQ(edge.is_high, told.at(edge.input) % 2 != 0);
      }
      for (const std::size_t i : {0U, 1U}) {
        ASSERT_EQ(told.at(i) % 2 != 0, wires.at(i)) << seed << " step " << step;
        ASSERT_EQ(levels_of(*sut).is_high(i), wires.at(i));
        ASSERT_EQ(rig->wire(kOutputLines.at(i)), outputs.at(i));
      }
    }
  }
}

}  // namespace thimble::test
