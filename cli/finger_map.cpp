#include "cli/finger_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace thimble::cli {
namespace {

constexpr std::size_t kFrameLines = 3;  // two edges and the legend
constexpr std::size_t kMinRows = 5;
constexpr std::size_t kMaxRows = 15;
constexpr const char* kIndent = "    ";
constexpr const char* kGap = "    ";
constexpr double kDefaultExtent_m = 0.09;  // the thesis's workspace, for worlds not told of

struct Signs {
  const char *wall, *free, *finger, *touching, *hand, *horizontal, *vertical;
  std::array<const char*, 4> corners;
};
constexpr Signs kUnicode{"░", " ", "○", "●", "+", "─", "│", {"┌", "┐", "└", "┘"}};
constexpr Signs kAscii{":", " ", "o", "@", "+", "-", "|", {"+", "+", "+", "+"}};

struct View {
  std::size_t across;  // axis to the right
  std::size_t up;
  const char* title;  // axis to the right, then axis up
};
constexpr std::size_t kHeight = 1;  // the axis y
constexpr std::array<View, 2> kViews{{{0, 1, " x y "}, {0, 2, " x z "}}};

struct Scene {
  std::size_t rows{0};
  std::size_t columns{0};
  std::array<double, 3> extent_m{kDefaultExtent_m, kDefaultExtent_m, kDefaultExtent_m};
  bool is_box{false};
  std::optional<api::SphereStatus> sphere;
  std::optional<api::BlockStatus> block;
  std::array<double, 3> hand_m{};
  std::array<double, 3> finger_m{};
  bool is_in_contact{false};
};

// The ball with some air around it, and no less than an arm's workspace.
double extent_around(const api::SphereStatus& sphere) {
  double half_m = kDefaultExtent_m / 2;
  for (const double center_m : sphere.center_m) {
    half_m = std::max(half_m, std::abs(center_m) + 1.2 * sphere.radius_m);
  }
  return 2 * half_m;
}

Scene scene_of(const api::ArmStatus& arm, const api::WorldStatus* world) {
  Scene out;
  out.is_in_contact = arm.is_in_contact;
  out.is_box = world != nullptr && world->source.starts_with("box:");
  if (world != nullptr) out.sphere = world->sphere;
  if (world != nullptr) out.block = world->block;
  for (std::size_t i = 0; i < 3; ++i) {
    out.hand_m[i] = arm.position_m[i];
    out.finger_m[i] = arm.felt.position_m[i];
    const double extent_m = world == nullptr ? 0 : world->cells[i] * world->cell_m;
    if (extent_m > 0 && std::isfinite(extent_m)) out.extent_m[i] = extent_m;
  }
  if (out.sphere) out.extent_m.fill(extent_around(*out.sphere));
  if (out.block) out.extent_m.fill(out.block->room_m);
  return out;
}

// Which of `count` places a coordinate falls into; nothing outside.
std::optional<std::size_t> place_of(double at_m, double extent_m, std::size_t count) {
  const double place = (at_m / extent_m + 0.5) * static_cast<double>(count);
  if (!(place >= 0 && place < static_cast<double>(count))) return std::nullopt;
  return static_cast<std::size_t>(place);
}

// The thesis's box is hollow in the middle third of each axis.
bool is_wall_of_box(const Scene& scene, std::size_t row, std::size_t column) {
  const auto is_outside = [](std::size_t place, std::size_t count) {
    const double middle = (static_cast<double>(place) + 0.5) / static_cast<double>(count) - 0.5;
    return std::abs(middle) > 1.0 / 6.0;
  };
  return is_outside(row, scene.rows) || is_outside(column, scene.columns);
}

// Of the `place`th of `count` characters along an axis.
double middle_m(std::size_t place, std::size_t count, double extent_m) {
  return ((static_cast<double>(place) + 0.5) / static_cast<double>(count) - 0.5) * extent_m;
}

bool is_before_block(const Scene& scene, const View& view, std::size_t row, std::size_t column) {
  const double across_m = middle_m(column, scene.columns, scene.extent_m[view.across]);
  const double up_m = middle_m(scene.rows - 1 - row, scene.rows, scene.extent_m[view.up]);
  const std::array<double, 3>& center_m = scene.block->center_m;
  return std::abs(across_m - center_m[view.across]) < scene.block->edge_m / 2 &&
         std::abs(up_m - center_m[view.up]) < scene.block->edge_m / 2;
}

// Cut through the middle of the ball.
bool is_in_sphere(const Scene& scene, const View& view, std::size_t row, std::size_t column) {
  const std::array<double, 3>& center_m = scene.sphere->center_m;
  const double across_m = middle_m(column, scene.columns, scene.extent_m[view.across]);
  const double up_m = middle_m(scene.rows - 1 - row, scene.rows, scene.extent_m[view.up]);
  // The cut of the view from above is as high as the middle of the ball.
  const double height_m = view.up == kHeight ? up_m : center_m[kHeight];
  const double from_middle_m =
      std::hypot(across_m - center_m[view.across], up_m - center_m[view.up]);
  return from_middle_m <= scene.sphere->radius_m || height_m < scene.sphere->floor_m;
}

bool is_wall(const Scene& scene, const View& view, std::size_t row, std::size_t column) {
  if (scene.is_box) return is_wall_of_box(scene, row, column);
  if (scene.block) return is_before_block(scene, view, row, column);
  return scene.sphere && is_in_sphere(scene, view, row, column);
}

// What of the world the picture does not show, and why; nothing where it shows all.
std::string missing_of(const Scene& scene, const api::WorldStatus* world) {
  if (world == nullptr) return "the world is not drawn: it is on another host";
  if (scene.is_box && world->edits_applied > 0) {
    return "the box is drawn as configured, without the edits since then";
  }
  if (scene.is_box || scene.block) return "";
  if (!scene.sphere) {
    return "the world's cells are not drawn: the status does not tell which are filled";
  }
  const bool is_floor_seen = scene.sphere->floor_m > -scene.extent_m[kHeight] / 2;
  return is_floor_seen ? "" : "the floor is below the picture";
}

bool is_at(const Scene& scene, const std::array<double, 3>& point_m, const View& view,
           std::size_t row, std::size_t column) {
  const auto across = place_of(point_m[view.across], scene.extent_m[view.across], scene.columns);
  const auto up = place_of(point_m[view.up], scene.extent_m[view.up], scene.rows);
  return across == column && up && scene.rows - 1 - *up == row;
}

std::string draw_row(const Scene& scene, const View& view, std::size_t row, const Signs& signs) {
  std::string out = signs.vertical;
  for (std::size_t column = 0; column < scene.columns; ++column) {
    if (is_at(scene, scene.finger_m, view, row, column)) {
      out += scene.is_in_contact ? signs.touching : signs.finger;
    } else if (is_at(scene, scene.hand_m, view, row, column)) {
      out += signs.hand;
    } else {
      out += is_wall(scene, view, row, column) ? signs.wall : signs.free;
    }
  }
  return out += signs.vertical;
}

std::string edge(const Scene& scene, const Signs& signs, const View* titled) {
  std::string out = signs.corners[titled != nullptr ? 0 : 2];
  std::size_t drawn = 0;
  if (titled != nullptr) {
    out += titled->title;
    drawn = columns_of(titled->title);
  }
  for (; drawn < scene.columns; ++drawn) out += signs.horizontal;
  return out += signs.corners[titled != nullptr ? 1 : 3];
}

}  // namespace

std::vector<std::string> finger_map(const api::ArmStatus& arm, const api::WorldStatus* world,
                                    Glyphs glyphs, std::size_t room) {
  if (room == 0) return {};
  const Signs& signs = glyphs == Glyphs::Unicode ? kUnicode : kAscii;
  Scene scene = scene_of(arm, world);
  const std::string missing = missing_of(scene, world);
  const std::size_t frame_lines = kFrameLines + (missing.empty() ? 0 : 1);
  if (room < kMinRows + frame_lines) {
    return missing.empty() ? std::vector<std::string>{} : std::vector{kIndent + missing};
  }
  // An odd number has a middle, where the box is hollow.
  const std::size_t rows = std::min((room - frame_lines - 1) / 2 * 2 + 1, kMaxRows);
  scene.rows = rows;
  scene.columns = 2 * rows + 1;  // a character is about twice as high as wide
  std::vector<std::string> out;
  out.push_back(kIndent + edge(scene, signs, &kViews[0]) + kGap + edge(scene, signs, &kViews[1]));
  for (std::size_t row = 0; row < rows; ++row) {
    out.push_back(kIndent + draw_row(scene, kViews[0], row, signs) + kGap +
                  draw_row(scene, kViews[1], row, signs));
  }
  out.push_back(kIndent + edge(scene, signs, nullptr) + kGap + edge(scene, signs, nullptr));
  out.push_back(kIndent + std::string(signs.finger) + " finger   " + signs.touching +
                " touching   " + signs.hand + " hand, where offset or delay part them");
  if (!missing.empty()) out.push_back(kIndent + missing);
  return out;
}

}  // namespace thimble::cli
