#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

constexpr std::array<Choice<ShapeKind>, 5> kKinds{{
    {"sphere", ShapeKind::Sphere},
    {"box", ShapeKind::Box},
    {"capsule", ShapeKind::Capsule},
    {"cylinder", ShapeKind::Cylinder},
    {"floor", ShapeKind::Floor},
}};
// Smaller than 1 mm a shape is lost in the hysteresis; farther than 1 m no arm reaches.
constexpr Range kSize{0.001, 2};
constexpr Range kRadius{0.001, 1};
constexpr Range kPlace{-1, 1};
constexpr Range kTurn{-6.3, 6.3};
constexpr std::size_t kMaxShapes = 32;  // what daemon/world looks at in one move

// Each size of a kind is needed, and no other taken.
struct Size {
  const char* key;
  const char* what;
  std::vector<ShapeKind> kinds;
};

const std::vector<Size>& sizes() {
  static const std::vector<Size> kSizes{
      {"radius_m", "a radius", {ShapeKind::Sphere, ShapeKind::Capsule, ShapeKind::Cylinder}},
      {"length_m", "a length", {ShapeKind::Capsule, ShapeKind::Cylinder}},
      {"size_m", "the three edges", {ShapeKind::Box}},
  };
  return kSizes;
}

ShapeConfig read_shape(TableReader& reader) {
  ShapeConfig out;
  reader.require("kind", "\"sphere\", \"box\", \"capsule\", \"cylinder\" or \"floor\"");
  const bool has_kind = reader.read("kind", std::span<const Choice<ShapeKind>>(kKinds), out.kind);
  std::optional<std::array<double, 3>> three;
  if (reader.read("center_m", kPlace, three)) out.center_m = *three;
  if (reader.read("rotation_rad", kTurn, three)) out.rotation_rad = *three;
  if (reader.read("size_m", kSize, three)) out.size_m = *three;
  reader.read("radius_m", kRadius, out.radius_m);
  reader.read("length_m", kSize, out.length_m);
  reader.read("stiffness_newton_per_m", {0, 20000, true}, out.stiffness_newton_per_m);
  reader.read("damping_newton_s_per_m", {0, 1000}, out.damping_newton_s_per_m);
  reader.read("friction", {0, 1}, out.friction);
  reader.read("temperature_kelvin", {0, 2000}, out.temperature_kelvin);
  for (const auto& [key, what, kinds] : sizes()) {
    if (!has_kind) break;
    const bool is_needed = std::find(kinds.begin(), kinds.end(), out.kind) != kinds.end();
    if (is_needed) reader.require(key, what);
    if (!is_needed && reader.has(key)) {
      reader.object(key, "expected only with a kind of shape that has it");
    }
  }
  reader.finish();
  return out;
}

}  // namespace

void read_shapes(TableReader& reader, WorldConfig& world) {
  std::vector<ShapeConfig> shapes;
  for (TableReader& table : reader.tables("shape")) shapes.push_back(read_shape(table));
  if (world.source != kShapesSource) {
    if (!shapes.empty() && !world.source.empty()) {
      reader.reject(
          "shape", "expected only with source \"shapes\", found beside " + in_quotes(world.source));
    }
    return;
  }
  if (shapes.empty() && !reader.has("shape")) {
    reader.object("source", "expected at least one [[world.shape]] beside \"shapes\", found none");
  }
  if (shapes.size() > kMaxShapes) {
    reader.reject("shape", "expected at most " + std::to_string(kMaxShapes) + " shapes, found " +
                               std::to_string(shapes.size()));
  }
  for (const char* key : {"workspace_m", "threshold"}) {
    if (!reader.has(key)) continue;
    reader.object(key, "expected only with a world of cells, found beside \"shapes\"");
  }
  world.shapes = std::move(shapes);
}

}  // namespace thimble::config
