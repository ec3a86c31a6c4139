#include "daemon/world/cam/piece_rules.hpp"

#include <gtest/gtest.h>

#include <utility>

// Particles of dynamic pieces (thesis 4.2.4).
namespace thimble::world::cam {
namespace {

// As the page of the rules has them.
constexpr unsigned kShapeBit = 1U << 1;
constexpr unsigned kForthBit = 1U << 7;
constexpr unsigned kBackBit = 1U << 8;
constexpr unsigned kDiceBit = 1U << 9;
constexpr unsigned kBeside = kForthBit | kBackBit | kDiceBit;
constexpr unsigned kHighSelect = 7U << 13;
constexpr unsigned kDriftBit = 1U << 13;
constexpr unsigned kEmitBit = 1U << 14;

// What a drift does to the three bits of a cell.
unsigned drifted(unsigned cell, bool is_emitting) {
  const bool is_dice = (cell & kDiceBit) != 0;
  const bool is_shape = (cell & kShapeBit) != 0;
  bool forth = (cell & kForthBit) != 0;
  bool back = (cell & kBackBit) != 0;
  if ((cell >> 4 & 7U) != 0) {
    forth = back = false;
  } else if (is_dice) {
    std::swap(forth, back);
    if (is_shape && is_emitting) forth = back = true;
  }
  return (forth ? kForthBit : 0) | (back ? kBackBit : 0) | (is_dice ? kDiceBit : 0);
}

TEST(DynamicRules, AreTheStaticOnesBesideWhatDrifts) {
  const PieceTables still = make_piece_tables();
  const PieceTables sut = make_piece_tables(true);
  const std::pair<const CamTable&, const CamTable&> tables[] = {{*sut.overlap, *still.overlap},
                                                                {*sut.grasp, *still.grasp},
                                                                {*sut.select, *still.select},
                                                                {*sut.deposit, *still.deposit},
                                                                {*sut.sweep, *still.sweep}};
  for (const auto& [table, of_still] : tables) {
    for (unsigned n = 0; n < 65'536; ++n) {
      const unsigned pieces = of_still[n & ~kBeside] & ~(kBeside | kHighSelect);
      ASSERT_EQ(table[n] & ~kBeside, pieces) << n;
      unsigned beside = n & kBeside;
      if (&table == sut.overlap.get() && (n & kDriftBit) != 0) {
        beside = drifted(n, (n & kEmitBit) != 0);
      }
      const bool is_deleted = (n & 2U) != 0 && n >> 10 == 0;
      if (&table == sut.deposit.get() && is_deleted) beside |= kForthBit | kBackBit;
      ASSERT_EQ(table[n] & kBeside, beside) << n;
    }
  }
}

}  // namespace
}  // namespace thimble::world::cam
