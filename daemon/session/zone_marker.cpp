#include "daemon/session/zone_marker.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "hal/base/check.hpp"
#include "sim/model/cam/rules/rule.hpp"

namespace thimble::session {
namespace {

using sim::cam::PlaneEngine;
using sim::cam::PlaneKick;

constexpr std::uint16_t kMark = 0x7;

std::uint32_t spread(std::uint32_t site) { return (site & kMark) != 0 ? kMark : 0; }

}  // namespace

ZoneMarker::ZoneMarker(std::unique_ptr<PlaneEngine> engine)
    : engine_(std::move(engine)), sites_(engine_->space().sites()) {}

Result<std::unique_ptr<ZoneMarker>> ZoneMarker::make(const CamAxes& log2_cells) {
  auto engine = PlaneEngine::make({log2_cells}, sim::cam::TablePath::Auto);
  if (!engine) return tl::unexpected(engine.error());
  if (auto loaded = (*engine)->load(0, sim::cam::table_of(spread)); !loaded) {
    return tl::unexpected(loaded.error());
  }
  // The constructor is private, so make_unique cannot reach it.
  return std::unique_ptr<ZoneMarker>(new ZoneMarker(*std::move(engine)));
}

void ZoneMarker::mark(std::span<const std::uint64_t> matter, std::int32_t cells,
                      std::span<std::uint64_t> zone) {
  for (std::size_t i = 0; i < sites_.size(); ++i) {
    sites_[i] = (matter[i / 64] >> (i % 64) & 1) != 0 ? kMark : 0;
  }
  THIMBLE_CHECK(engine_->put(sites_));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (engine_->space().log2_cells[axis] == 0) continue;
    for (std::int32_t reach = 0; reach < cells;) {
      const std::int32_t by = std::min(2 * reach + 1, cells - reach);
      std::array<PlaneKick, 2> kicks{PlaneKick{.layers = 0x2}, PlaneKick{.layers = 0x4}};
      kicks[0].cells[axis] = by;
      kicks[1].cells[axis] = -by;
      THIMBLE_CHECK(engine_->step(kicks, {}));
      reach += by;
    }
  }
  THIMBLE_CHECK(engine_->get_layer(0, zone));
}

}  // namespace thimble::session
