#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

// Smaller than 1 mm a ball is lost in the hysteresis; farther than 1 m no arm reaches.
constexpr Range kSphereRadius{0.001, 1};
constexpr Range kSpherePlace{-1, 1};
constexpr Range kFloor{-10, 1};

SphereConfig read_sphere_table(TableReader reader) {
  SphereConfig out;
  reader.read("radius_m", kSphereRadius, out.radius_m);
  std::optional<std::array<double, 3>> center;
  if (reader.read("center_m", kSpherePlace, center)) out.center_m = *center;
  reader.read("floor_m", kFloor, out.floor_m);
  reader.read("stiffness_newton_per_m", {0, 20000, true}, out.stiffness_newton_per_m);
  reader.read("damping_newton_s_per_m", {0, 1000}, out.damping_newton_s_per_m);
  reader.read("friction", {0, 1}, out.friction);
  reader.read("temperature_kelvin", {0, 2000}, out.temperature_kelvin);
  const double top_m = out.center_m[1] + out.radius_m;
  if (!(top_m > out.floor_m)) {
    reader.reject("floor_m", "expected a floor below the top of the sphere, which is at " +
                                 shown(top_m) + ", found " + shown(out.floor_m));
    out = {};  // one that can be, for who looks at the rest
  }
  reader.finish();
  return out;
}

}  // namespace

void read_sphere(TableReader& reader, WorldConfig& world) {
  const SphereConfig sphere = read_sphere_table(reader.table("sphere"));
  if (world.source != kSphereSource) {
    if (reader.has("sphere") && !world.source.empty()) {
      reader.reject("sphere", "expected only with source \"sphere\", found beside " +
                                  in_quotes(world.source));
    }
    return;
  }
  world.sphere = sphere;
  for (const char* key : {"workspace_m", "threshold"}) {
    if (!reader.has(key)) continue;
    reader.object(key, "expected only with a world of cells, found beside \"sphere\"");
  }
}

}  // namespace thimble::config
