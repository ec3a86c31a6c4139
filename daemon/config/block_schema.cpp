#include <array>
#include <optional>

#include "daemon/config/schema.hpp"

namespace thimble::config {
namespace {

// A millimeter is as small as a wall's hysteresis lets one feel; farther than 1 m no arm reaches.
constexpr Range kEdge{0.001, 1};
constexpr Range kDrag{1, 10'000};
// No arm holds more for long.
constexpr Range kWeight{-20, 20};

BlockConfig read_block_table(TableReader reader) {
  BlockConfig out;
  reader.read("room_m", kEdge, out.room_m);
  reader.read("edge_m", kEdge, out.edge_m);
  reader.read("drag_newton_s_per_m", kDrag, out.drag_newton_s_per_m);
  reader.read("friction", {0, 1}, out.friction);
  std::optional<std::array<double, 3>> weight;
  if (reader.read("weight_newton", kWeight, weight)) out.weight_newton = *weight;
  if (!(out.edge_m < out.room_m)) {
    reader.reject("edge_m", "expected a block smaller than its room of " + shown(out.room_m) +
                                ", found " + shown(out.edge_m));
    out = {};  // one that can be, for who looks at the rest
  }
  reader.finish();
  return out;
}

}  // namespace

void read_block(TableReader& reader, WorldConfig& world) {
  const BlockConfig block = read_block_table(reader.table("block"));
  if (world.source == kBlockSource) {
    world.block = block;
    for (const char* key : {"workspace_m", "threshold"}) {
      if (!reader.has(key)) continue;
      reader.object(key, "expected only with a world of cells, found beside \"block\"");
    }
    return;
  }
  if (!reader.has("block") || world.source.empty()) return;
  reader.reject("block",
                "expected only with source \"block\", found beside " + in_quotes(world.source));
}

}  // namespace thimble::config
