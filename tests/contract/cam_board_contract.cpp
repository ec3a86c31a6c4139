#include "tests/contract/cam_board_contract.hpp"

#include <random>

#include "tests/contract/cam_board_oracle.hpp"

namespace thimble::test {
namespace {

using namespace cam_step;

TEST_P(CamBoardContract, RandomProgramsDoWhatAPlainArrayDoes) {
  std::mt19937 random(7);
  ASSERT_TRUE(sut.lay_out(space));
  CamBoardOracle oracle(space);
  ASSERT_TRUE(play(oracle.first_program(random)));
  for (int i = 0; i < 40; ++i) {
    const CamSteps steps = random_steps(random, space);
    const auto answer = play(steps);
    ASSERT_TRUE(answer) << answer.error().message;
    const CamAnswer expected = oracle.play(steps);
    ASSERT_EQ(answer->counts, expected.counts) << i;
    ASSERT_EQ(answer->cells, expected.cells) << i;
  }
  EXPECT_EQ(sut.counters(), (CamBoardCounters{.started = 41, .done = 41}));
}

TEST_P(CamBoardContract, NothingRunsBeforeThereIsASpace) {
  EXPECT_TRUE(sut.needs_lay_out());
  EXPECT_EQ(play({}).error().code, Errc::InvalidArgument);
  EXPECT_EQ(sut.lay_out({{30, 0, 0}, CamDivision::Mesh}).error().code, Errc::InvalidArgument);
  EXPECT_TRUE(sut.needs_lay_out());
  ASSERT_TRUE(sut.lay_out(space));
  EXPECT_FALSE(sut.needs_lay_out());
  EXPECT_TRUE(play({}));
}

TEST_P(CamBoardContract, LaidOutAnewItKeepsItsCellsAndForgetsWhatWasSet) {
  std::mt19937 random(9);
  const auto cells = CamBoardOracle::random_words(random, space.cells());
  ASSERT_TRUE(sut.lay_out(space));
  ASSERT_TRUE(play({WriteCells{cells}, Count{CamEvents::Site}, Fix{0xffff, 0}}));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(sut.lay_out(space));
    const auto answer = play(
        {ReadCells{}, cam_step::Run{{.is_scan = false, .takes_counts = true}}, cam_step::Run{},
         cam_step::Run{{.is_scan = false, .takes_counts = true}}, ReadCounts{}, WriteCells{cells}});
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->cells.at(0), *cells);
    EXPECT_EQ(answer->counts.at(0), CamCounts{});
  }
}

// Of two layers that move within a box; elsewhere the table changes nothing.
TEST_P(CamBoardContract, WithinABoxAScanDoesWhatOneOfTheWholeDoes) {
  std::mt19937 random(11);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  ASSERT_TRUE(sut.lay_out(space));
  CamBoardOracle oracle(space);
  ASSERT_TRUE(play(oracle.first_program(random)));
  CamTable table(kCamTableEntries);
  for (std::size_t n = 0; n < table.size(); ++n) {
    table[n] = static_cast<std::uint16_t>((n & 3) == 0 ? n : n ^ (random() & 0xfffc));
  }
  const CamBox whole{{}, {1 << space.log2_cells[0], 1 << space.log2_cells[1], 1}};
  for (int i = 0; i < 12; ++i) {
    const CamBox box{{below(whole.cells[0]), below(whole.cells[1]), 0}, {3, 2, 1}};
    CamCells cells = *CamBoardOracle::random_words(random, space.cells());
    for (auto& bits : cells) bits &= 0xfffc;
    cells[static_cast<std::size_t>(box.first[0] + box.first[1] * whole.cells[0])] |= 3;
    const CamSteps steps{WriteCells{std::make_shared<const CamCells>(cells)},
                         LoadTable{std::make_shared<const CamTable>(table)},
                         Fix{},
                         Count{CamEvents::Table, 3},
                         Within{box},
                         Kick{{{1, {2, 0, 0}}, {2, {1, 1, 0}}}},
                         cam_step::Run{{.takes_counts = true, .swaps_tables = true}},
                         cam_step::Run{{.takes_counts = true}},
                         ReadCounts{},
                         Within{},
                         cam_step::Run{},
                         ReadCells{}};
    const auto answer = play(steps);
    ASSERT_TRUE(answer) << answer.error().message;
    const CamAnswer expected = oracle.play(steps);
    ASSERT_EQ(answer->counts, expected.counts) << i;
    ASSERT_EQ(answer->cells, expected.cells) << i;
  }
}

TEST_P(CamBoardContract, OneProgramAtATimeAndItsAnswerOnce) {
  ASSERT_TRUE(sut.lay_out(space));
  ASSERT_TRUE(play({}));
  EXPECT_EQ(sut.poll(rig->now()).error().code, Errc::InvalidArgument);
  ASSERT_TRUE(sut.start({cam_step::Run{}}, kPatience, rig->now()));
  EXPECT_TRUE(sut.is_running());
  EXPECT_EQ(sut.start({}, kPatience, rig->now()).error().code, Errc::Busy);
  EXPECT_EQ(sut.lay_out(space).error().code, Errc::Busy);
  while (!sut.poll(rig->now()).value()) rig->pass(std::chrono::microseconds(20));
  EXPECT_FALSE(sut.is_running());
  EXPECT_EQ(sut.poll(rig->now()).error().code, Errc::InvalidArgument);
}

TEST_P(CamBoardContract, WhatCannotBeIsRefusedAndTheBoardSeesNothing) {
  ASSERT_TRUE(sut.lay_out(space));
  ASSERT_TRUE(play({}));
  const auto some = std::make_shared<const CamCells>(3);
  const Kick kick{{{1, {1, 0, 0}}}};
  const CamSteps wrong[] = {
      {LoadTable{}},
      {LoadTable{some}},
      {WriteCells{}},
      {WriteCells{some}},

      {kick, kick},
      {kick, ReadCells{}},
      {kick, cam_step::Show{}},
      {cam_step::Show{-1}},
      {cam_step::Show{1 << space.log2_cells[2]}},
      {kick, cam_step::Run{{.repeats_kick = true}}},
      {cam_step::Run{{.is_scan = false, .repeats_kick = true}}},
      {Within{CamBox{{0, 0, 0}, {1, 0, 1}}}},
      {Within{CamBox{{0, -1, 0}, {1, 1, 1}}}},
      {Within{CamBox{{0, 0, 0}, {1, 1, 1 + (1 << space.log2_cells[2])}}}},
  };
  for (const CamSteps& steps : wrong) {
    const auto answer = play(steps);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().code, Errc::InvalidArgument) << answer.error().message;
  }
  EXPECT_EQ(sut.counters(), (CamBoardCounters{.started = 1, .done = 1, .refused = 14}));
  EXPECT_TRUE(play({kick, cam_step::Run{}})) << "a refused kick does not wait";
}

TEST_P(CamBoardContract, AnUnpluggedBoardIsGoneForGood) {
  ASSERT_TRUE(sut.lay_out(space));
  ASSERT_TRUE(sut.start({cam_step::Run{}}, kPatience, rig->now()));
  rig->unplug();
  const auto said = sut.poll(rig->now());
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().code, Errc::Disconnected);
  EXPECT_FALSE(sut.is_running());
  EXPECT_TRUE(sut.needs_lay_out());
  ASSERT_TRUE(sut.lay_out(space));
  EXPECT_EQ(play({}).error().code, Errc::Disconnected);
  EXPECT_EQ(sut.counters(), (CamBoardCounters{.started = 1, .failed = 1, .refused = 1}));
}

}  // namespace
}  // namespace thimble::test
