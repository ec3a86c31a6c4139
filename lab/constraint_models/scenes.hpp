#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/world/shapes/shape.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/base/geometry.hpp"

// The places that the figures draw. Everything lies in the plane z = 0, x to the right and y up.
namespace thimble::lab {

// The end of a part of the hand's way, and how many planes are to hold a ghost there.
struct FigureStage {
  std::string name;  // as in the figure
  Position3 hand{};
  int planes{0};
  int simple_planes{0};  // the same of the simple model, where it plays
};

// A straight line of matter's outline, for the plots.
using Outline = std::vector<std::pair<double, double>>;  // m

struct Scene {
  std::string name;
  std::string title;
  std::vector<world::Shape> matter{};
  std::optional<world::VoxelGrid> cells{};  // the same matter, where cells can be it
  Position3 start{};
  std::vector<FigureStage> stages{};
  std::vector<Outline> outlines{};
};

// Ours: the figures have no scale.
inline constexpr double kCell_m = 0.010;

// Figures 3-8 and 3-9: (a) to (d) through a cell, (e) out of it sideways, (f) past it and sideways,
// and into a corner of cells.
[[nodiscard]] std::vector<Scene> figure_scenes();
// Figure 3-10: a floor and a wall whose free side has `angle_rad` between them, at the origin; the
// hand goes into the floor, along it into the corner, and along the wall out.
[[nodiscard]] Scene corner_scene(const std::string& name, const std::string& title,
                                 double angle_rad);

}  // namespace thimble::lab
