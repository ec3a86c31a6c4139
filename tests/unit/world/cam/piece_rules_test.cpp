#include "daemon/world/cam/piece_rules.hpp"

#include <gtest/gtest.h>

namespace thimble::world::cam {
namespace {

// Each for all 65,536 cells.
class EveryCell : public testing::Test {
 protected:
  struct Read {
    bool origin, shape, grasp, overlap;
    int part, select;
    bool operator==(const Read&) const = default;
  };
  static Read read(unsigned bits) {
    return {(bits & 1U) != 0,
            (bits & 2U) != 0,
            (bits & 4U) != 0,
            (bits & 8U) != 0,
            static_cast<int>(bits >> 4) & 63,
            static_cast<int>(bits >> 10) & 63};
  }
  template <class Check>
  static void each(std::uint16_t (*rule)(std::uint16_t) noexcept, Check check) {
    for (unsigned n = 0; n < 65'536; ++n) {
      const Read before = read(n);
      const Read after = read(rule(static_cast<std::uint16_t>(n)));
      check(before, after);
      if (testing::Test::HasFailure()) FAIL() << n;
    }
  }
  // What is seen in the picture.
  static void expect_shown(const Read& cell) {
    EXPECT_EQ(cell.select, cell.shape ? 63 : cell.part);
  }
};

TEST_F(EveryCell, MotionMarksOverlapAndChangesNothingElse) {
  each(overlap_rule, [](const Read& before, const Read& after) {
    EXPECT_EQ(after.overlap, before.shape && before.part != 0);
    EXPECT_EQ(after.origin, before.origin);
    EXPECT_EQ(after.shape, before.shape);
    EXPECT_EQ(after.grasp, before.grasp);
    EXPECT_EQ(after.part, before.part);
    expect_shown(after);
  });
}

TEST_F(EveryCell, GraspingTellsThePieceUnderTheGraspPointAlone) {
  each(grasp_rule, [](const Read& before, const Read& after) {
    Read expected = before;
    expected.select = before.grasp ? before.part : 0;
    EXPECT_EQ(after, expected);
  });
}

TEST_F(EveryCell, SelectingTurnsOnePieceIntoTheShapeAndLeavesItsOrigin) {
  each(select_rule, [](const Read& before, const Read& after) {
    const bool is_it = before.part != 0 && before.part == before.select;
    EXPECT_EQ(after.shape, is_it);
    EXPECT_EQ(after.origin, is_it);
    EXPECT_EQ(after.part, is_it ? 0 : before.part);
    EXPECT_EQ(after.grasp, before.grasp);
    expect_shown(after);
  });
}

TEST_F(EveryCell, DepositingPutsTheShapeDownOrLeavesWhatWasThere) {
  each(deposit_rule, [](const Read& before, const Read& after) {
    EXPECT_EQ(after.part, before.shape && before.select != 0 ? before.select : before.part);
    EXPECT_EQ(after.shape, before.grasp);
    EXPECT_EQ(after.grasp, before.grasp);
    EXPECT_FALSE(after.origin);
    EXPECT_FALSE(after.overlap);
    expect_shown(after);
  });
}

TEST(PieceTables, AreTheRules) {
  const PieceTables tables = make_piece_tables();
  for (unsigned n = 0; n < 65'536; ++n) {
    const auto bits = static_cast<std::uint16_t>(n);
    ASSERT_EQ((*tables.overlap)[n], overlap_rule(bits));
    ASSERT_EQ((*tables.grasp)[n], grasp_rule(bits));
    ASSERT_EQ((*tables.select)[n], select_rule(bits));
    ASSERT_EQ((*tables.deposit)[n], deposit_rule(bits));
  }
}

TEST(PieceTables, ThatShowNothingDoTheSameAndLeaveSelectEmpty) {
  for (const bool is_dynamic : {false, true}) {
    const PieceTables shown = make_piece_tables(is_dynamic);
    const PieceTables sut = make_piece_tables(is_dynamic, false);
    EXPECT_EQ(*sut.grasp, *shown.grasp) << "it is what the host asks for";
    EXPECT_EQ(*sut.sweep, *shown.sweep);
    for (unsigned n = 0; n < 65'536; ++n) {
      ASSERT_EQ((*sut.overlap)[n], (*shown.overlap)[n] & 0x03ff);
      ASSERT_EQ((*sut.select)[n], (*shown.select)[n] & 0x03ff);
      ASSERT_EQ((*sut.deposit)[n], (*shown.deposit)[n] & 0x03ff);
    }
  }
}

}  // namespace
}  // namespace thimble::world::cam
