#include "lab/constraint_models/judge.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::lab {
namespace {

// Where planes meet at a sharp angle, project() is exact to 3e4 times its tolerance.
constexpr double kTouch_m = 3e4 * world::kPlaneTolerance_m;

}  // namespace

void judge(const Model& model, const std::vector<world::PlacedShape>& matter, const HeldHand& held,
           Verdict& verdict) {
  ++verdict.steps;
  bool is_outside = false;
  bool is_pulling = false;
  bool is_untouched = false;
  for (std::size_t i = 0; i < held.planes.size(); ++i) {
    const double past_m = held.planes[i].past_m - dot(held.planes[i].normal, held.projection.past);
    const double share_m = held.projection.share[i];
    is_outside = is_outside || past_m > kTouch_m;
    is_pulling = is_pulling || share_m < 0;
    is_untouched = is_untouched || (share_m > 0 && std::abs(past_m) > kTouch_m);
  }
  verdict.outside += is_outside ? 1U : 0U;
  verdict.pulling += is_pulling ? 1U : 0U;
  verdict.untouched += is_untouched ? 1U : 0U;
  verdict.most_planes = std::max(verdict.most_planes, held.planes.size());
  if (!model.has_ghost) return;
  verdict.apart_m = std::max(verdict.apart_m, norm(held.proxy - held.ghost));
  double deep_m = 0;
  for (const world::PlacedShape& shape : matter) {
    deep_m = std::max(deep_m, -shape.look(held.ghost).distance_m);
  }
  verdict.deepest_m = std::max(verdict.deepest_m, deep_m);
  if (deep_m > model.matter_m) ++verdict.in_matter;
}

}  // namespace thimble::lab
