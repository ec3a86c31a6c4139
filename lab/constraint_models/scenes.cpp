#include "lab/constraint_models/scenes.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

namespace thimble::lab {
namespace {

constexpr std::uint32_t kCells = 7;
constexpr std::uint32_t kMiddle = kCells / 2;

// The middle of cell (i, j) of the figures, in the layer of the hand.
Position3 at_cell(double i, double j) {
  return {(i - kMiddle) * kCell_m, (j - kMiddle) * kCell_m, 0};
}

Scene cells_scene(const std::string& name, const std::string& title,
                  const std::vector<std::pair<int, int>>& filled, std::vector<FigureStage> stages) {
  Scene scene{name, title, {}, {}, at_cell(1, 1), std::move(stages), {}};
  world::VoxelGrid grid = *world::VoxelGrid::create({kCells, kCells, kCells}, kCell_m);
  const double half_m = kCell_m / 2;
  for (const auto& [i, j] : filled) {
    for (std::int32_t z = 0; z < static_cast<std::int32_t>(kCells); ++z) {
      grid.set_occupied({i, j, z}, true);
    }
    const Position3 middle = at_cell(i, j);
    scene.matter.push_back({.kind = world::ShapeKind::Box,
                            .center = middle,
                            .half_m = {half_m, half_m, kCells * half_m}});
    scene.outlines.push_back({{middle.x - half_m, middle.y - half_m},
                              {middle.x + half_m, middle.y - half_m},
                              {middle.x + half_m, middle.y + half_m},
                              {middle.x - half_m, middle.y + half_m},
                              {middle.x - half_m, middle.y - half_m}});
  }
  scene.cells = std::move(grid);
  return scene;
}

}  // namespace

std::vector<Scene> figure_scenes() {
  const FigureStage a{"a: a free cell", at_cell(1, 1), 0, 0};
  const FigureStage b{"b: in an occupied one", at_cell(1, 1.8), 1, 1};
  const FigureStage c{"c: back", at_cell(1, 1), 0, 0};
  const FigureStage d{"d: through it", at_cell(1, 3), 1, 1};
  // The simple model goes on holding whom it should let go: its fault.
  const FigureStage e{"e: out of its side", at_cell(2, 1.8), 0, 1};
  const FigureStage f{"f: past it, and beside", at_cell(2, 3), 0, 1};
  return {
      cells_scene("through", "Through a cell (figures 3-8a to d, 3-9)", {{1, 2}}, {a, b, c, d}),
      cells_scene("side", "Into a cell and out of its side (figure 3-8e)", {{1, 2}}, {a, b, e}),
      cells_scene("past", "Through a cell and past it (figure 3-8f)", {{1, 2}}, {a, b, d, f}),
      cells_scene("neighbors", "Along two cells side by side, and past the second",
                  {{1, 2}, {2, 2}},
                  {a,
                   b,
                   {"into its neighbor", at_cell(2, 1.8), 1, 1},
                   {"beside both", at_cell(3, 1.8), 0, 1}}),
      cells_scene("cell-corner", "Into a corner of cells: two planes (figure 3-7)",
                  {{1, 2}, {2, 2}, {2, 1}},
                  {a,
                   b,
                   {"into the corner", at_cell(1.8, 1.8), 2, 1},
                   {"along the wall", at_cell(1.8, 1), 1, 0},
                   c}),
  };
}

Scene corner_scene(const std::string& name, const std::string& title, double angle_rad) {
  constexpr double kWall_m = 0.010;  // half its thickness
  constexpr double kDeep_m = 0.004;
  constexpr double kOut_m = 0.020;
  const Displacement3 along_wall{std::cos(angle_rad), std::sin(angle_rad), 0};
  const Displacement3 into_wall{-along_wall.y, along_wall.x, 0};
  const Displacement3 middle{std::cos(angle_rad / 2), std::sin(angle_rad / 2), 0};
  const Position3 origin{};
  Scene scene{name, title, {}, {}, origin + kOut_m * middle, {}, {}};
  const Displacement3 half{0.05, kWall_m, 0.05};
  scene.matter = {{.kind = world::ShapeKind::Box, .center = {0.02, -kWall_m, 0}, .half_m = half},
                  {.kind = world::ShapeKind::Box,
                   .center = origin + kWall_m * into_wall + 0.02 * along_wall,
                   .turn_rad = {0, 0, angle_rad},
                   .half_m = half}};
  // As far along the floor as no wall is near; then past the corner in both.
  const double free_m = kOut_m;
  const Position3 deep = origin - 1.5 * kDeep_m * middle;
  scene.stages = {{"free", scene.start, 0, 0},
                  {"in the floor", {free_m, -kDeep_m, 0}, 1, 0},
                  {"in the corner", deep, 2, 0},
                  {"in the wall", origin + free_m * along_wall + kDeep_m * into_wall, 1, 0},
                  {"free again", scene.start, 0, 0}};
  scene.outlines = {{{0.03, 0}, {0, 0}, {0.03 * along_wall.x, 0.03 * along_wall.y}}};
  return scene;
}

}  // namespace thimble::lab
