#include <algorithm>
#include <array>
#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {

bool is_volume_file(std::string_view source) {
  constexpr std::array<std::string_view, 3> kEndings{".npy", ".nrrd", ".nhdr"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](std::string_view ending) { return source.ends_with(ending); });
}

namespace {

constexpr Range kFileNumber{-1e9, 1e9};
constexpr std::array<std::string_view, 4> kSurfaceKeys{
    "stiffness_newton_per_m", "damping_newton_s_per_m", "friction", "temperature_kelvin"};
constexpr std::size_t kMaxMaterials = 15;  // what daemon/world can tell apart

[[nodiscard]] bool is_axis_order(std::string_view order) {
  constexpr std::string_view kAxes = "xyz";
  std::string letters;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i] == '-' && i + 1 < order.size() && order[i + 1] != '-') continue;
    letters += order[i];
  }
  return std::is_permutation(letters.begin(), letters.end(), kAxes.begin(), kAxes.end());
}

// What changes nothing is a mistake: who wrote it expects to feel it.
void refuse_without_effect(TableReader& reader, const MaterialConfig& material, double threshold) {
  if (material.to >= material.from && material.to <= threshold) {
    reader.object(reader.has("to") ? "to" : "from",
                  "expected a number above world.threshold, " + shown(threshold) +
                      ", since no other cell is filled; found " + shown(material.to));
  }
  const auto is_said = [&](std::string_view key) { return reader.has(key); };
  if (std::none_of(kSurfaceKeys.begin(), kSurfaceKeys.end(), is_said)) {
    reader.object("name",
                  "expected stiffness_newton_per_m, damping_newton_s_per_m, friction or "
                  "temperature_kelvin beside it, found none");
  }
}

MaterialConfig read_material(TableReader& reader, double threshold) {
  MaterialConfig out;
  reader.require("name", "a name");
  reader.read("name", out.name);
  reader.require("from", "a number of the file");
  reader.read("from", kFileNumber, out.from);
  out.to = out.from;
  if (reader.read("to", kFileNumber, out.to) && out.to < out.from) {
    reader.reject("to", "expected a number not below from, found " + shown(out.to));
  }
  reader.read("stiffness_newton_per_m", {0, 20000, true}, out.stiffness_newton_per_m);
  reader.read("damping_newton_s_per_m", {0, 1000}, out.damping_newton_s_per_m);
  reader.read("friction", {0, 1}, out.friction);
  reader.read("temperature_kelvin", {0, 2000}, out.temperature_kelvin);
  refuse_without_effect(reader, out, threshold);
  reader.finish();
  return out;
}

void read_materials(TableReader& reader, WorldConfig& world) {
  for (TableReader& table : reader.tables("material"))
    world.materials.push_back(read_material(table, world.threshold));
  if (world.materials.size() > kMaxMaterials) {
    reader.reject("material", "expected at most " + std::to_string(kMaxMaterials) +
                                  " materials, found " + std::to_string(world.materials.size()));
  }
}

}  // namespace

void read_volume(TableReader& reader, WorldConfig& world) {
  // One mistake is told once: what is wrong in itself is not also out of place.
  const bool is_for_box = !world.source.empty() && !is_volume_file(world.source);
  const auto check_place = [&](std::string_view key) {
    if (!is_for_box) return;
    reader.reject(key, "expected only with a volume file, found beside " + in_quotes(world.source));
  };
  reader.read("workspace_m", {0, 10, true}, world.workspace_m);
  reader.read("threshold", {-1e9, 1e9}, world.threshold);
  if (reader.read("cell_m", {0, 1, true}, world.cell_m)) {
    if (reader.has("workspace_m")) {
      reader.reject("cell_m", "expected either cell_m or workspace_m, found both");
    } else {
      check_place("cell_m");
    }
  }
  if (reader.read("spacing", {0, 1e6, true}, world.spacing)) check_place("spacing");
  read_materials(reader, world);
  if (!world.materials.empty()) check_place("material");
  std::string order;
  if (!reader.read("axis_order", order)) return;
  if (!is_axis_order(order)) {
    return reader.reject("axis_order",
                         "expected the letters of \"xyz\" in any order, each with or without a - "
                         "before it, found " +
                             in_quotes(order));
  }
  world.axis_order = order;
  check_place("axis_order");
}

}  // namespace thimble::config
