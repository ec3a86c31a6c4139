#include <gtest/gtest.h>

#include <random>

#include "drivers/cambus/board.hpp"
#include "drivers/cambus/pci_port.hpp"
#include "sim/model/cam/sim_cam_board.hpp"
#include "sim/time/virtual_clock.hpp"
#include "tests/contract/cam_board_oracle.hpp"

// Programs within a box, over edges of modules and of the space, beside a plain array that knows of
// no box: the same cells, the same counts, and fewer clocks.
namespace thimble::cambus {
namespace {

using namespace cam_step;
using test::CamBoardOracle;

struct Rig {
  const char* name;
  sim::cam::TorusShape shape;
  CamGeometry space;
};
void PrintTo(const Rig& rig, std::ostream* out) { *out << rig.name; }

constexpr CamLayers kMoving = 0x0007;

class BoardWithin : public testing::TestWithParam<Rig> {
 protected:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  [[nodiscard]] int length(std::size_t axis) const {
    return 1 << GetParam().space.log2_cells[axis];
  }
  CamAnswer play(const CamSteps& steps) {
    EXPECT_TRUE(board_.start(steps, std::chrono::seconds(1), clock_.now()));
    while (true) {
      auto answer = board_.poll(clock_.now());
      if (answer && !*answer) continue;
      if (!answer) ADD_FAILURE() << answer.error().message;
      return answer ? **std::move(answer) : CamAnswer{};
    }
  }
  // Anything where something moves, nothing elsewhere.
  std::shared_ptr<const CamTable> table() {
    CamTable table(kCamTableEntries);
    for (std::size_t n = 0; n < table.size(); ++n) {
      table[n] = static_cast<std::uint16_t>((n & kMoving) == 0 ? n : random_());
    }
    return std::make_shared<const CamTable>(std::move(table));
  }
  [[nodiscard]] std::size_t index_of(const CamAxes& cell) const {
    std::size_t index = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
      const int bits = GetParam().space.log2_cells[axis];
      index = index << bits | static_cast<std::size_t>(cell[axis] & (length(axis) - 1));
    }
    return index;
  }
  // Noise, in which layers that move are only in some cells from the box's `lead_` on.
  std::shared_ptr<const CamCells> cells_for(const CamBox& box) {
    CamCells cells = *CamBoardOracle::random_words(random_, GetParam().space.cells());
    for (auto& bits : cells) bits &= static_cast<std::uint16_t>(~kMoving);
    for (int n = 0; n < 40; ++n) {
      CamAxes cell{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cell[axis] = box.first[axis] + from_[axis] + below(to_[axis] - from_[axis] + 1);
      }
      cells[index_of(cell)] |= static_cast<std::uint16_t>(1 + random_() % 7);
    }
    return std::make_shared<const CamCells>(std::move(cells));
  }
  // A box somewhere, and what of it may have something that moves.
  CamBox box() {
    CamBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] = below(length(axis));
      box.cells[axis] = 1 + below(std::min(length(axis), 20));
      from_[axis] = below(box.cells[axis]);
      to_[axis] = from_[axis] + below(box.cells[axis] - from_[axis]);
    }
    return box;
  }
  // Of some layers, so that nothing leaves the box; nowhere, when there is no room.
  CamKick kick(const CamBox& box) {
    CamKick kick{static_cast<CamLayers>(random_() & kMoving), {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int room = below(2) == 0 ? -from_[axis] : box.cells[axis] - 1 - to_[axis];
      const int most = std::min(std::abs(room), std::max(length(axis) / 8, 1));
      const int by = below(most + 1);
      kick.cells[axis] = room < 0 ? -by : by;
      (room < 0 ? from_ : to_)[axis] += kick.cells[axis];
    }
    return kick;
  }
  CamSteps program(const CamBox& box) {
    CamSteps steps{WriteCells{cells_for(box)}, LoadTable{table()},
                   cam_step::Run{{.is_scan = false, .takes_counts = true, .swaps_tables = true}},
                   LoadTable{table()},
                   Count{below(2) == 0 ? CamEvents::Site : CamEvents::Table, 0x0005}};
    steps.emplace_back(Within{box});
    for (int n = 0; n < 6; ++n) {
      const bool is_kicked = below(3) != 0;
      if (is_kicked) steps.emplace_back(Kick{{kick(box)}});
      steps.emplace_back(cam_step::Run{
          {.takes_counts = below(2) == 0, .swaps_tables = is_kicked && below(3) == 0}});
      steps.emplace_back(ReadCounts{});
    }
    if (below(2) == 0) steps.emplace_back(Within{});
    steps.emplace_back(cam_step::Run{{.takes_counts = true}});
    steps.emplace_back(ReadCounts{});
    steps.emplace_back(ReadCells{});
    return steps;
  }
  std::uint64_t clocks() { return slot_.board().machine().now_clocks(); }

  std::mt19937 random_{17};
  CamAxes from_{}, to_{};  // within the box: where something may be
  sim::VirtualClock clock_;
  sim::cam::SimCamBoard slot_{
      clock_, {.shape = GetParam().shape, .window_bytes = std::size_t{1} << 22, .is_paced = false}};
  Board board_{PciPort::open(slot_.open_window(), clock_.now()).value()};
};

TEST_P(BoardWithin, DoesWhatAPlainArrayDoes) {
  ASSERT_TRUE(board_.lay_out(GetParam().space));
  CamBoardOracle oracle(GetParam().space);
  for (int i = 0; i < 12; ++i) {
    const CamSteps steps = program(box());
    const CamAnswer answer = play(steps);
    const CamAnswer expected = oracle.play(steps);
    ASSERT_EQ(answer.counts, expected.counts) << i;
    ASSERT_EQ(answer.cells, expected.cells) << i;
  }
  const auto& counters = slot_.board().machine().counters();
  EXPECT_EQ(counters.disturbed_scans, 0U);
  EXPECT_EQ(counters.site_by_site, 0U);
}

// A box of a few cells on an edge of everything, in as many parts as there are.
TEST_P(BoardWithin, TakesFewerClocksThanTheWhole) {
  ASSERT_TRUE(board_.lay_out(GetParam().space));
  const auto clocks_of = [&](const std::optional<CamBox>& box) {
    play({cam_step::Run{}});
    const auto before = clocks();
    play({Within{box}, Kick{{{1, {1, 1, 0}}}}, cam_step::Run{},
          cam_step::Run{{.repeats_kick = true}}, cam_step::Run{},
          cam_step::Run{{.is_scan = false, .takes_counts = true}}});
    return clocks() - before;
  };
  const std::uint64_t whole = clocks_of(std::nullopt);
  EXPECT_LT(clocks_of(CamBox{{length(0) - 2, length(1) - 2, 0}, {4, 4, 1}}), whole);
  EXPECT_LT(clocks_of(CamBox{{1, length(1) / 2 - 2, 0}, {4, 4, 1}}), whole);
  EXPECT_EQ(clocks_of(CamBox{{}, {length(0), length(1), length(2)}}), whole);
}

INSTANTIATE_TEST_SUITE_P(
    Cam, BoardWithin,
    testing::Values(Rig{"OneModule", {{1, 1, 1}, 14}, {{7, 7, 0}, CamDivision::Mesh}},
                    Rig{"EightInStrips", {{2, 2, 2}, 13}, {{8, 8, 0}, CamDivision::StripY}},
                    Rig{"FourAsMesh", {{2, 2, 1}, 13}, {{6, 6, 3}, CamDivision::Mesh}},
                    Rig{"FourAlongX", {{2, 2, 1}, 13}, {{7, 5, 3}, CamDivision::StripX}},
                    Rig{"ACube", {{2, 1, 1}, 14}, {{5, 5, 5}, CamDivision::StripY}}),
    [](const auto& rig) { return rig.param.name; });

}  // namespace
}  // namespace thimble::cambus
