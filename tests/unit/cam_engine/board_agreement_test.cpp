#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "sim/model/cam/engine/plane_engine.hpp"
#include "tests/unit/cam/cam_bench.hpp"
#include "tests/unit/cam_engine/plain_space.hpp"

// Random programs on the fast engine and, through the driver's step lists, on the board that is
// simulated register by register: the same bits in the same places, and the same counts.
namespace thimble::sim::cam {
namespace {

using cambus::CamProgram;
using cambus::Division;
using cambus::LayerKick;
using cambus::test::CamBench;
using cambus::test::Layout;

class BoardAgreement : public testing::TestWithParam<Layout> {
 protected:
  // As the engine's step, bank by bank of the board's two.
  PlaneCounts board_step(const test::Table& table, const std::vector<LayerKick>& kicks,
                         const StepOptions& options) {
    CamProgram program(board.space());
    program.load_table(table);
    EXPECT_TRUE(program.kick({}));
    program.run({.is_scan = false, .takes_counts = true, .swaps_tables = true});
    program.fix(options.fixed, options.fixed_bits);
    program.count(options.counting == Counting::Nothing ? CamProgram::Events::None
                  : options.counting == Counting::Sites ? CamProgram::Events::Site
                                                        : CamProgram::Events::Table);
    const auto kicked = program.kick(kicks);
    EXPECT_TRUE(kicked) << kicked.error().message;
    program.run();
    program.fix(0, 0);
    program.run({.is_scan = false, .takes_counts = true});
    const auto slots = program.read_counts();
    board.play(program);
    PlaneCounts counts{};
    for (const auto& slot : slots) {
      for (int layer = 0; layer < 16; ++layer) {
        counts[static_cast<std::size_t>(layer)] +=
            cambus::count_of_layer(board.words_of(slot), layer);
      }
    }
    return counts;
  }
  // Not further than a module is long, where modules divide the axis.
  std::vector<LayerKick> random_kicks(std::mt19937& random) const {
    std::vector<LayerKick> kicks;
    for (unsigned layer = 0; layer < 16; ++layer) {
      LayerKick& kick = kicks.emplace_back();
      kick.layers = static_cast<LayerBits>(1U << layer);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int most = 1 << board.space().log2_sector()[axis];
        kick.cells[axis] = static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most;
      }
    }
    return kicks;
  }
  void expect_agreement(TablePath path, std::mt19937& random) {
    const SiteSpace space{GetParam().log2_cells};
    const auto engine = PlaneEngine::make(space, path).value();
    test::Cells cells = test::random_cells(space.sites(), random);
    board.put(cells);
    ASSERT_TRUE(engine->put(cells));
    for (int i = 0; i < 3; ++i) {
      const test::Table table = path == TablePath::General ? test::random_table(random)
                                                           : test::random_small_table(random);
      ASSERT_TRUE(engine->load(0, table));
      StepOptions options;
      options.fixed = static_cast<LayerBits>(random() & random());
      options.fixed_bits = static_cast<LayerBits>(random());
      options.counting = static_cast<Counting>(random() % 3);
      const std::vector<LayerKick> kicks = random_kicks(random);
      std::vector<PlaneKick> same;
      for (const LayerKick& kick : kicks) same.push_back({kick.layers, kick.cells});
      ASSERT_EQ(engine->step(same, options).value(), board_step(table, kicks, options)) << i;
      ASSERT_TRUE(engine->get(cells));
      ASSERT_EQ(cells, board.get()) << i;
    }
  }

  CamBench board{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Layouts, BoardAgreement,
                         testing::Values(Layout{{0, 0, 0}, {4, 3, 2}, Division::Mesh},
                                         Layout{{1, 0, 0}, {7, 3, 0}, Division::Mesh},
                                         Layout{{1, 1, 0}, {5, 4, 1}, Division::Mesh},
                                         Layout{{1, 1, 1}, {4, 4, 3}, Division::Mesh},
                                         Layout{{1, 1, 1}, {6, 5, 0}, Division::StripY}));

TEST_P(BoardAgreement, OfTablesThatAreLookedUp) {
  std::mt19937 random(61);
  expect_agreement(TablePath::General, random);
}

TEST_P(BoardAgreement, OfTablesThatAreCompiled) {
  std::mt19937 random(62);
  expect_agreement(TablePath::Compiled, random);
}

}  // namespace
}  // namespace thimble::sim::cam
