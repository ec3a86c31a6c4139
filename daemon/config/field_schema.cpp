#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

void read_mesh_keys(TableReader& table, bool is_mesh, FieldConfig& out) {
  table.read("longest_m", {1e-3, 10}, out.longest_m);
  table.read_integer("resolution", {8, 256}, out.resolution);
  if (out.longest_m && out.unit_m) {
    table.reject("longest_m", "expected either longest_m or unit_m, found both");
  }
  for (const char* key : {"longest_m", "resolution"}) {
    if (is_mesh || !table.has(key)) continue;
    table.object(key, "expected only with a mesh, which ends in .stl or .obj");
  }
}

}  // namespace

bool is_mesh_file(std::string_view source) {
  std::string ending(source.substr(source.size() - std::min<std::size_t>(4, source.size())));
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".stl" || ending == ".obj";
}

// A table that is there, even an empty one, says that the numbers are distances; a mesh needs none.
void read_field(TableReader& reader, WorldConfig& world) {
  const bool is_mesh = is_mesh_file(world.source);
  TableReader table = reader.table("field");
  FieldConfig out;
  out.is_mesh = is_mesh;
  table.read("unit_m", {1e-6, 1e3}, out.unit_m);
  read_mesh_keys(table, is_mesh || world.source.empty(), out);
  std::optional<std::array<double, 3>> center;
  if (table.read("center_m", {-1, 1}, center)) out.center_m = *center;
  table.read("stiffness_newton_per_m", {0, 20000, true}, out.stiffness_newton_per_m);
  table.read("damping_newton_s_per_m", {0, 1000}, out.damping_newton_s_per_m);
  table.read("friction", {0, 1}, out.friction);
  table.read("temperature_kelvin", {0, 2000}, out.temperature_kelvin);
  table.finish();
  if (world.source.empty() || (!table.is_present() && !is_mesh)) return;
  if (!is_mesh && !is_volume_file(world.source)) {
    return reader.reject("field", "expected only with a volume file or a mesh, found beside " +
                                      in_quotes(world.source));
  }
  const std::string beside = is_mesh ? "a mesh" : "[world.field]";
  for (const char* key : {"threshold", "material"}) {
    if (!reader.has(key)) continue;
    // What a volume file alone has is told by its own reader.
    if (is_mesh && key == std::string_view("material")) continue;
    reader.object(key, "expected only with a volume of cells, found beside " + beside);
  }
  if (is_mesh && reader.has("workspace_m")) {
    reader.object("workspace_m", "expected longest_m or unit_m in [world.field] with a mesh");
  }
  world.field = out;
}

}  // namespace thimble::config
