#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "pushed_edge.hpp"

// The question at the end of thesis 3.6, whether a part that is pushed from cell to cell feels like
// a ratchet: docs/pushed-edge.md. The page's table is measured again here.
namespace thimble::coupling {
namespace {

using std::chrono::milliseconds;
using testing::PushedEdge;
using testing::Ratchet;
using testing::Told;

struct Row {
  int delay_ms{0};
  double cell_mm{0};
  Told told{Told::ByGhostPoint};
  int cells{0};
  int teeth{0};
  int to_nothing{0};
  double fall_newton{0};
  double peak_newton{0};
  double offset_mm{0};
};

Told told_by(const std::string& name) {
  if (name == "buffer zone") return Told::ByBufferZone;
  if (name == "simple model") return Told::BySimpleModel;
  EXPECT_EQ(name, "ghost point");
  return Told::ByGhostPoint;
}

std::vector<Row> rows_of_the_page() {
  std::ifstream page(THIMBLE_SOURCE_DIR "/docs/pushed-edge.md");
  std::vector<Row> rows;
  for (std::string line; std::getline(page, line);) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, '|');) cells.push_back(cell);
    if (cells.size() != 10 || cells[1].find_first_of("0123456789") != 1) continue;
    const std::string name = cells[3].substr(1, cells[3].size() - 2);
    rows.push_back({std::stoi(cells[1]), std::stod(cells[2]), told_by(name), std::stoi(cells[4]),
                    std::stoi(cells[5]), std::stoi(cells[6]), std::stod(cells[7]),
                    std::stod(cells[8]), std::stod(cells[9])});
  }
  return rows;
}

Ratchet measure(double cell_mm, Told told, int delay_ms) {
  const double cells = std::round(90 / cell_mm);
  return testing::push_edge(0.090 / cells, told, milliseconds(delay_ms));
}

TEST(Ratchet, IsAsThePageSays) {
  const std::vector<Row> rows = rows_of_the_page();
  ASSERT_GE(rows.size(), 30U);
  for (const Row& row : rows) {
    const Ratchet sut = measure(row.cell_mm, row.told, row.delay_ms);
    const std::string where =
        std::to_string(row.delay_ms) + " ms, " + std::to_string(row.cell_mm) + " mm";
    EXPECT_NEAR(sut.cells, row.cells, 1) << where;
    EXPECT_NEAR(sut.teeth.count(), row.teeth, 2) << where;
    EXPECT_NEAR(sut.teeth.to_nothing(), row.to_nothing, 2) << where;
    EXPECT_NEAR(sut.teeth.mean_newton(), row.fall_newton, 0.1) << where;
    EXPECT_NEAR(sut.teeth.largest_newton(), row.peak_newton, 0.1) << where;
    EXPECT_NEAR(1e3 * sut.offset_m, row.offset_mm, 0.5) << where;
  }
}

// One tooth a cell; it falls by the stiffness times the cell, or to nothing.
TEST(Ratchet, OnOneHostEachCellIsAToothWithGhostPointAndBufferZoneAlike) {
  for (const Told told : {Told::ByGhostPoint, Told::ByBufferZone}) {
    for (const double cell_mm : {3.0, 2.0, 1.40625, 1.0, 0.703125}) {
      const Ratchet sut = measure(cell_mm, told, 1);
      EXPECT_NEAR(sut.teeth.count(), sut.cells, 1) << cell_mm;
      const double spring_newton = testing::kHardWall.newton_per_m * cell_mm * 1e-3;
      const bool is_lost = spring_newton > PushedEdge::kBreak_newton;
      EXPECT_NEAR(sut.teeth.to_nothing(), is_lost ? sut.cells : 0, 1) << cell_mm;
      const double fall_newton = is_lost ? sut.teeth.mean_newton() : spring_newton;
      EXPECT_NEAR(sut.teeth.mean_newton(), fall_newton, 0.05) << cell_mm;
      EXPECT_EQ(sut.offset_m, 0);
    }
  }
}

TEST(Ratchet, ASoftSurfaceMakesCoarseCellsSmooth) {
  const Ratchet hard = measure(1.40625, Told::ByGhostPoint, 1);
  const Ratchet soft = testing::push_edge(0.00140625, Told::ByGhostPoint, milliseconds(1), {100});
  EXPECT_EQ(hard.cells, soft.cells);
  EXPECT_GT(hard.teeth.count(), 14);
  EXPECT_EQ(soft.teeth.count(), 0);
}

TEST(Ratchet, TheFinestCellsOfTheThesisAreSmooth) {
  for (const Told told : {Told::ByGhostPoint, Told::ByBufferZone}) {
    for (const int delay_ms : {1, 20}) {
      const Ratchet sut = measure(0.17578125, told, delay_ms);
      EXPECT_EQ(sut.teeth.count(), 0);
      EXPECT_GT(sut.cells, 140);
    }
  }
}

// The worry was that an object overreacts: the finger gets more than it gave.
TEST(Ratchet, TheGhostPointNeverAddsMoreThanSpeedTimesDelayToThePush) {
  constexpr double kNoise_newton = 0.65;  // damping of a quantised speed, and the tooth's swing
  for (const int delay_ms : {1, 20, 50, 100}) {
    for (const double cell_mm : {3.0, 1.40625, 0.703125, 0.17578125}) {
      const Ratchet sut = measure(cell_mm, Told::ByGhostPoint, delay_ms);
      const double deeper_newton = testing::kHardWall.newton_per_m * 0.05 * delay_ms * 1e-3;
      EXPECT_LE(sut.teeth.largest_newton(),
                PushedEdge::kBreak_newton + deeper_newton + kNoise_newton);
      EXPECT_NEAR(sut.edge_travel_m, sut.cells * cell_mm * 1e-3 - cell_mm * 1e-3,
                  2 * cell_mm * 1e-3);
    }
  }
}

// Its first face holds until the finger comes back: nothing gives way under the finger.
TEST(Ratchet, InTheSimpleModelAPartCannotBePushed) {
  for (const double cell_mm : {3.0, 1.40625, 0.703125}) {
    const Ratchet sut = measure(cell_mm, Told::BySimpleModel, 1);
    EXPECT_GT(sut.teeth.largest_newton(), 7);
    EXPECT_LT(sut.hand_travel_m, 0.009) << "of 25 mm";
  }
}

}  // namespace
}  // namespace thimble::coupling
