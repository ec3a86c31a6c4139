#include "drivers/cambus/cam_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <set>
#include <utility>

#include "drivers/cambus/cam_program.hpp"
#include "drivers/cambus/step_list_check.hpp"

namespace thimble::cambus {
namespace {

std::vector<BoardShape> all_boards() {
  std::vector<BoardShape> boards;
  for (int n = 0; n < 27; ++n) boards.push_back({{n % 3, n / 3 % 3, n / 9}, 22});
  return boards;
}

// Whether a pin of a module at `from` leads to `to`: XM, XP, YM, YP, ZM, ZP.
bool leads(const BoardShape& board, Axes from, std::size_t pin, const Axes& to) {
  const std::size_t axis = pin / 2;
  const int length = 1 << board.log2_modules[axis];
  from[axis] = (from[axis] + (pin % 2 == 1 ? 1 : length - 1)) % length;
  return from == to;
}

TEST(CamSpace, TheWayGoesThroughAllModulesByTheirWires) {
  for (const BoardShape& board : all_boards()) {
    std::set<Axes> passed;
    std::set<std::pair<int, std::size_t>> ends;  // of wires: none is used twice
    for (int n = 0; n < board.modules(); ++n) {
      passed.insert(position_of(board, n));
      if (board.modules() == 1) continue;
      const int next = (n + 1) % board.modules();
      const std::size_t pin = pin_to_next(board, n);
      EXPECT_TRUE(leads(board, position_of(board, n), pin, position_of(board, next)));
      EXPECT_TRUE(ends.insert({n, pin}).second);
      EXPECT_TRUE(ends.insert({next, pin ^ 1U}).second);
    }
    EXPECT_EQ(passed.size(), static_cast<std::size_t>(board.modules()));
  }
}

// Ports of the y-strip of eight, from step/step-lang.fth: y- and y+ by module; XM is pin 0, ZP 5.
TEST(CamSpace, EightModulesInAStripAreConnectedAsMitDid) {
  constexpr std::array<std::pair<int, int>, 8> kPins{
      {{5, 1}, {0, 3}, {2, 0}, {1, 5}, {4, 1}, {0, 2}, {3, 0}, {1, 4}}};
  const CamSpace space = CamSpace::make({{1, 1, 1}, 22}, {9, 9, 0}, Division::StripY).value();
  for (int module = 0; module < 8; ++module) {
    const RegisterWords words = space.connect(module);
    for (int pin = 0; pin < 6; ++pin) {
      const auto [minus, plus] = kPins[static_cast<std::size_t>(module)];
      const std::uint32_t expected = pin == minus ? 2 : pin == plus ? 3 : 7;
      EXPECT_EQ(words.get(field::kConnect[static_cast<std::size_t>(pin)], 7), expected)
          << module << " " << pin;
    }
  }
}

TEST(CamSpace, EveryCellHasASiteOfItsOwn) {
  for (const Division division :
       {Division::Mesh, Division::StripX, Division::StripY, Division::StripZ}) {
    const CamSpace space = CamSpace::make({{1, 1, 1}, 22}, {4, 4, 4}, division).value();
    std::set<std::pair<int, std::uint32_t>> places;
    for (int i = 0; i < 4096; ++i) {
      const CellPlace place = space.place_of({i % 16, i / 16 % 16, i / 256});
      EXPECT_LT(place.module, 8);
      EXPECT_LT(place.site, 512U);
      places.insert({place.module, place.site});
    }
    EXPECT_EQ(places.size(), 4096U);
  }
}

TEST(CamSpace, A512SquareOnEightBoardsIsLaidOutAsTheThesisHadIt) {
  const CamSpace space = CamSpace::make({{1, 1, 1}, 22}, {9, 9, 0}, Division::StripY).value();
  EXPECT_EQ(space.log2_sector(), (Axes{9, 6, 0}));
  const RegisterWords dimension = space.dimension();
  EXPECT_EQ(dimension.get(field::kCuts, 0), (1U << 8) | (1U << 14));
  EXPECT_EQ(dimension.get(field::kDimension[1], 0), 31U);  // x wraps within
  EXPECT_EQ(dimension.get(field::kDimension[2], 0), 14U);
  EXPECT_EQ(dimension.get(field::kDimension[3], 0), 31U);
  const RegisterWords format = space.scan_format(space.whole());
  EXPECT_EQ(format.get(field::kScanMode, 0), 3U);
  EXPECT_EQ(format.get(field::kEndOfScan, 0), 15U);
  EXPECT_EQ(format.get(field::kEndOfSweep, 0), 9U);
  EXPECT_EQ(format.get(field::kRefreshLength, 0), 2U);
  EXPECT_EQ(space.scan_perm(space.whole()).get(field::kScanPerm[14], 0), 14U);
  EXPECT_EQ(space.scan_perm(space.whole()).get(field::kScanPerm[15], 0), kConstant0);
}

// The manual's table of kicks for a dimension of eight bits.
TEST(CamSpace, KicksHaveTheManualsForm) {
  const CamSpace space = CamSpace::make({{1, 0, 0}, 22}, {9, 4, 0}, Division::Mesh).value();
  struct Row {
    int cells;
    std::uint32_t amount, sign, most;
  };
  for (const Row& row : {Row{256, 0, 0, 1}, Row{255, 255, 0, 0}, Row{1, 1, 0, 0}, Row{0, 0, 0, 0},
                         Row{-1, 255, 1, 0}, Row{-255, 1, 1, 0}, Row{-256, 0, 1, 0}}) {
    const std::vector<LayerKick> kicks{{1U << 3, {row.cells, 0, 0}}};
    const RegisterWords words = space.kick(kicks).value();
    EXPECT_EQ(words.get(field::kKickAmount, 3), row.amount) << row.cells;
    EXPECT_EQ(words.get(field::kKick[1], 3), row.sign) << row.cells;
    EXPECT_EQ(words.get(field::kKick[4], 3), row.most) << row.cells;
    EXPECT_EQ(words.get(field::kKickAmount, 2), 0U);
  }
}

TEST(CamSpace, KicksThatAreTooLongAreRefused) {
  const CamSpace space = CamSpace::make({{1, 0, 0}, 22}, {4, 4, 0}, Division::Mesh).value();
  const auto is_taken = [&](const Axes& cells) {
    const std::vector<LayerKick> kicks{{0x0001, cells}};
    return space.kick(kicks).has_value();
  };
  EXPECT_TRUE(is_taken({8, 0, 0}));
  EXPECT_TRUE(is_taken({-8, 1000, 0}));  // y is within a module
  EXPECT_FALSE(is_taken({9, 0, 0}));
  EXPECT_FALSE(is_taken({-9, 0, 0}));
}

TEST(CamSpace, SpacesThatDoNotFitAreRefused) {
  const BoardShape box{{1, 1, 1}, 22};
  EXPECT_TRUE(CamSpace::make(box, {9, 9, 7}, Division::Mesh));
  EXPECT_FALSE(CamSpace::make(box, {9, 9, 8}, Division::Mesh));
  EXPECT_FALSE(CamSpace::make(box, {9, 3, 0}, Division::StripY));  // a cell for each module
  EXPECT_TRUE(CamSpace::make(box, {9, 4, 0}, Division::StripY));
  EXPECT_FALSE(CamSpace::make({{3, 0, 0}, 22}, {9, 9, 0}, Division::Mesh));
  EXPECT_FALSE(CamSpace::make(box, {9, 9, -1}, Division::StripY));
}

// Whether the registers of a block let a scan visit this site.
bool is_visited(const CamSpace& space, const ScanBlock& block, std::uint32_t site) {
  const RegisterWords perm = space.scan_perm(block);
  for (std::size_t bit = 0; bit < kAddressBits; ++bit) {
    const std::uint32_t code = perm.get(field::kScanPerm[bit], 0);
    if (code >= kAddressBits && (code == kConstant1) != ((site >> bit & 1U) != 0)) return false;
  }
  return true;
}

// Address bits are as many index bits as a scan counts through.
void expect_one_visit_each(const CamSpace& space, const ScanBlock& block) {
  std::set<std::uint32_t> codes;
  for (const Field& of : field::kScanPerm) {
    const std::uint32_t code = space.scan_perm(block).get(of, 0);
    const bool is_again = code < kAddressBits && !codes.insert(code).second;
    EXPECT_FALSE(is_again);
  }
  EXPECT_EQ(codes.size(), space.scan_format(block).get(field::kEndOfScan, 0));
  EXPECT_TRUE(codes.empty() || *codes.rbegin() + 1 == codes.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(block.first[axis] & ((1 << block.log2_cells[axis]) - 1), 0);
  }
}

TEST(CamSpace, BlocksAroundABoxHaveAllOfItAndNoSiteTwice) {
  std::mt19937 random(4);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::array<int, 9> seen{};  // by how many blocks there were
  for (int i = 0; i < 400; ++i) {
    const Axes log2{4 + below(4), 4 + below(4), 4 + below(4)};
    const BoardShape board{{below(2), below(2), below(2)}, 22};
    const auto division = static_cast<Division>(below(4));
    const auto space = CamSpace::make(board, log2, division);
    if (!space) continue;
    CamBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.first[axis] = below(1 << log2[axis]);
      box.cells[axis] = 1 + below(below(2) == 0 ? 8 : 1 << log2[axis]);
    }
    const auto blocks = space->blocks_around(box).value();
    std::uint64_t clocks = 0;
    for (const ScanBlock& block : blocks) {
      expect_one_visit_each(*space, block);
      clocks += space->clocks_of(block);
    }
    EXPECT_LE(clocks, space->clocks_of(space->whole()));
    const auto visits = [&](std::uint32_t site) {
      return std::count_if(blocks.begin(), blocks.end(),
                           [&](const ScanBlock& block) { return is_visited(*space, block, site); });
    };
    for (int n = 0; n < 30; ++n) {
      ASSERT_LE(visits(static_cast<std::uint32_t>(below(1 << space->log2_sector_sites()))), 1);

      Axes cell{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cell[axis] = (box.first[axis] + below(box.cells[axis])) & ((1 << log2[axis]) - 1);
      }
      ASSERT_EQ(visits(space->place_of(cell).site), 1);
    }
    ++seen[blocks.size()];
  }
  for (const std::size_t blocks : {1U, 2U, 4U, 8U}) EXPECT_GT(seen[blocks], 0) << blocks;
}

TEST(CamSpace, ABlockIsWhatThePermuterSays) {
  const CamSpace space = CamSpace::make({{1, 1, 1}, 22}, {9, 9, 0}, Division::StripY).value();
  const auto blocks = space.blocks_around({{70, 130, 0}, {20, 6, 1}}).value();
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0], (ScanBlock{{64, 0, 0}, {5, 3, 0}}));
  const RegisterWords perm = space.scan_perm(blocks[0]);
  for (std::size_t bit = 0; bit < kAddressBits; ++bit) {
    const auto n = static_cast<std::uint32_t>(bit);
    const std::uint32_t expected = n < 5 ? n : n == 6 ? kConstant1 : kConstant0;
    const bool is_y = n >= 9 && n < 12;
    EXPECT_EQ(perm.get(field::kScanPerm[bit], 5), is_y ? n - 4 : expected) << bit;
  }
  const RegisterWords format = space.scan_format(blocks[0]);
  EXPECT_EQ(format.get(field::kEndOfScan, 0), 8U);
  EXPECT_EQ(format.get(field::kEndOfSweep, 0), 5U);
  EXPECT_EQ(format.get(field::kScanMode, 0), 2U) << "an open part of a row";
}

// Over a slow bus what has to be said of a block counts, too.
TEST(CamSpace, BlocksAreFewerWhereEachTakesLongToSay) {
  const CamSpace space = CamSpace::make({{1, 1, 1}, 22}, {9, 9, 0}, Division::StripY).value();
  const CamBox middle{{240, 240, 0}, {32, 32, 1}};
  EXPECT_EQ(space.blocks_around(middle).value().size(), 4U);
  EXPECT_EQ(space.blocks_around(middle, 24).value().size(), 2U) << "25 MHz over 1 MB/s";
  EXPECT_EQ(space.blocks_around(middle, 1000).value(), std::vector<ScanBlock>{space.whole()});
}

TEST(CamSpace, ABoxThatLeavesNothingOutIsTheWhole) {
  const CamSpace space = CamSpace::make({{1, 1, 1}, 22}, {9, 9, 0}, Division::StripY).value();
  const std::vector<ScanBlock> whole{space.whole()};
  EXPECT_EQ(space.blocks_around({{0, 0, 0}, {512, 512, 1}}).value(), whole);
  EXPECT_EQ(space.blocks_around({{200, 60, 0}, {500, 62, 1}}).value(), whole);
  EXPECT_FALSE(space.blocks_around({{0, 0, 0}, {513, 1, 1}}));
  EXPECT_FALSE(space.blocks_around({{0, 0, 0}, {1, 0, 1}}));
  EXPECT_FALSE(space.blocks_around({{512, 0, 0}, {1, 1, 1}}));
  EXPECT_FALSE(space.blocks_around({{0, 0, -1}, {1, 1, 1}}));
}

TEST(CamProgram, EveryWordOfItIsTakenByTheChecker) {
  for (const BoardShape& board : all_boards()) {
    const CamSpace space = CamSpace::make(board, {5, 5, 5}, Division::Mesh).value();
    CamProgram program(space);
    program.number_modules();
    program.set_up();
    program.load_table(LookupTable(kTableEntries, 1));
    ASSERT_TRUE(program.kick({}));
    program.fix(layers(4, 9), 0x03f0);
    program.count(CamProgram::Events::Table);
    program.run({.takes_counts = true, .swaps_tables = true});
    program.scan_within({{0, 0, 0}, {1, 0, 1}});
    program.run();
    program.scan_within(space.whole());
    EXPECT_EQ(program.read_counts().size(), static_cast<std::size_t>(board.modules()));
    program.write_sites(0, LookupTable(std::size_t{1} << space.log2_sector_sites(), 7));
    static_cast<void>(program.read_sites(space.modules() - 1));
    const StepList list = program.finish();
    const auto summary = check_step_list(list.view(), list.head);
    EXPECT_TRUE(summary) << summary.error().message;
  }
}

TEST(CamProgram, LayersAndCounts) {
  EXPECT_EQ(layers(0, 0), 0x0001);
  EXPECT_EQ(layers(4, 9), 0x03f0);
  EXPECT_EQ(layers(10, 15), 0xfc00);
  EXPECT_EQ(layers(0, 15), 0xffff);
  std::vector<std::uint16_t> words(kEventBits);
  words[0] = 0x8001;
  words[24] = 0x8000;
  EXPECT_EQ(count_of_layer(words, 0), 1U);
  EXPECT_EQ(count_of_layer(words, 15), (1U << 24) + 1);
  EXPECT_EQ(count_of_layer(words, 7), 0U);
}

}  // namespace
}  // namespace thimble::cambus
