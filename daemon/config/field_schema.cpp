#include <array>
#include <optional>
#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {

// A table that is there, even an empty one, says that the numbers are distances.
void read_field(TableReader& reader, WorldConfig& world) {
  TableReader table = reader.table("field");
  FieldConfig out;
  table.read("unit_m", {1e-6, 1e3}, out.unit_m);
  std::optional<std::array<double, 3>> center;
  if (table.read("center_m", {-1, 1}, center)) out.center_m = *center;
  table.read("stiffness_newton_per_m", {0, 20000, true}, out.stiffness_newton_per_m);
  table.read("damping_newton_s_per_m", {0, 1000}, out.damping_newton_s_per_m);
  table.read("friction", {0, 1}, out.friction);
  table.finish();
  if (!table.is_present() || world.source.empty()) return;
  if (!is_volume_file(world.source)) {
    return reader.reject(
        "field", "expected only with a volume file, found beside " + in_quotes(world.source));
  }
  for (const char* key : {"threshold", "material"}) {
    if (!reader.has(key)) continue;
    reader.object(key, "expected only with a volume of cells, found beside [world.field]");
  }
  world.field = out;
}

}  // namespace thimble::config
