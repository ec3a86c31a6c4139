#include <string>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

// Ours: as many cells as in the thesis's worlds, 2^18.
constexpr Range kInPlane{32, 512};
constexpr Range kInSpace{16, 64};

AutomatonConfig read_automaton_table(TableReader reader, bool is_crystal) {
  AutomatonConfig out;
  std::int64_t number = 0;
  if (reader.read_integer("axes", {2, 3}, number)) out.axes = static_cast<int>(number);
  if (out.axes == 3 && !is_crystal) {
    reader.reject("axes", "expected 2: only a crystal grows in space, found 3");
    out.axes = 2;
  }
  if (out.axes == 3) out.cells = static_cast<int>(kInSpace.max);
  read_power(reader, "cells", out.axes == 3 ? kInSpace : kInPlane, out.cells);
  if (reader.read_integer("seed", {0, 9007199254740992.0}, number)) {
    out.seed = static_cast<std::uint64_t>(number);
  }
  reader.read("fill_fraction", {0, 1}, out.fill_fraction);
  reader.read("steps_per_s", {0, 1000}, out.steps_per_s);
  reader.read("poke_cells", {0.5, 64}, out.poke_cells);
  reader.finish();
  return out;
}

}  // namespace

void read_automaton(TableReader& reader, WorldConfig& world) {
  const bool is_crystal = world.source == kCrystalSource;
  const AutomatonConfig automaton =
      read_automaton_table(reader.table("automaton"), is_crystal || world.source.empty());
  if (!is_crystal && world.source != kLifeSource) {
    if (reader.has("automaton") && !world.source.empty()) {
      reader.reject("automaton",
                    "expected only with source \"life\" or \"crystal\", found beside " +
                        in_quotes(world.source));
    }
    return;
  }
  world.automaton = automaton;
  if (!reader.has("threshold")) return;
  reader.object("threshold",
                "expected only with a volume file, found beside " + in_quotes(world.source));
}

}  // namespace thimble::config
