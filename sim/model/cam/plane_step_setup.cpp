#include <algorithm>

#include "sim/model/cam/plane_step.hpp"

namespace thimble::sim::cam {
namespace {

using cambus::kLayers;

bool has(LayerBits layers, std::size_t layer) { return (layers >> layer & 1) != 0; }

bool looks_at_source(const PlaneSource& source) { return (source.map & 3) != source.map >> 2; }
bool needs_table(const PlaneSource& source) {
  return source.select == cambus::kSelectLutOrAddress && looks_at_source(source);
}
bool is_constant(const PlaneSource& source) {
  return source.map == cambus::kMapZero || source.map == cambus::kMapOne;
}
// Where nothing crosses an edge, a glued bit is the site's own.
bool is_own_bit(const PlaneSource& source) {
  return source.map == cambus::kMapSite ||
         (source.map == cambus::kMapSource && source.select == cambus::kSelectUnglued);
}

}  // namespace

PlaneStep::PlaneStep(const CamTorus& torus, const Parts& parts)
    : parts_(parts),
      wires_(parts.which.size()),
      work_(parts.which.size()),
      is_looked_up_(parts.which.size(), false),
      visited_(parts.plan.orders.front().visited()),
      sites_(parts.plan.orders.size()) {
  StepRooms& rooms = parts_.rooms;
  rooms.modules.resize(std::max(rooms.modules.size(), parts_.which.size()));
  rooms.taken.resize(rooms.modules.size());
  rooms.sites.resize(std::max(rooms.sites.size(), sites_.size()));
  for (const ModulePlan& module : parts_.plan.modules) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        may_cross_[layer][axis] |= module.layers[layer].crossings[axis].is_possible();
      }
    }
  }
  find_wires(torus);
  for (std::size_t i = 0; i < work_.size(); ++i) find_work(i);
}

void PlaneStep::find_wires(const CamTorus& torus) {
  for (std::size_t i = 0; i < work_.size(); ++i) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const LayerPlan& here = parts_.plan.modules[i].layers[layer];
        if (!here.crossings[axis].is_possible()) continue;
        const std::size_t in_port = 2 * axis + (here.is_minus[axis] ? 1 : 0);
        for (std::size_t pin = 0; pin < kPins; ++pin) {
          if (here.connections[pin] != in_port) continue;
          add_wire(torus.neighbor(parts_.which[i], pin), pin, layer, axis, wires_[i][layer][axis]);
        }
      }
    }
  }
}

// Data goes out of the port on the side that the sign says and comes in by the other one: from
// every pin that is connected to it, ORed.
void PlaneStep::add_wire(std::size_t module, std::size_t pin, std::size_t layer, std::size_t axis,
                         Wires& wires) const {
  const auto& which = parts_.which;
  const auto found = std::find(which.begin(), which.end(), module);
  if (found == which.end()) {  // it does not scan: nobody drives the wire
    wires.constant = ~Word{0};
    return;
  }
  const auto other = static_cast<std::size_t>(found - which.begin());
  const LayerPlan& there = parts_.plan.modules[other].layers[layer];
  const std::uint32_t code = there.connections[CamTorus::opposite(pin)];
  const std::size_t out_port = 2 * axis + (there.is_minus[axis] ? 0 : 1);
  if (code == out_port) {
    wires.others.push_back(other);
  } else if (code != cambus::kPinIs0) {
    wires.constant = ~Word{0};  // undriven wires are pulled up
  }
}

void PlaneStep::find_work(std::size_t i) {
  const PreparedTable& table = *parts_.tables[i];
  const LayerBits inputs = table.rule ? table.rule->inputs : table.shape.inputs;
  const bool is_shown = parts_.looked_at == i;
  bool is_looked_up = false;
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    const LayerPlan& plan = parts_.plan.modules[i].layers[layer];
    const auto& crosses = may_cross_[layer];
    const bool is_kept = has(table.shape.kept, layer);
    const bool is_glued = std::find(crosses.begin(), crosses.end(), true) != crosses.end();
    const bool keeps_bit =
        is_own_bit(plan.site_data) ||
        (is_kept && is_own_bit(plan.lut) && plan.site_data.map == cambus::kMapSource &&
         plan.site_data.select == cambus::kSelectLutOrAddress);
    Work& work = work_[i][layer];
    work.is_stored = is_glued || !keeps_bit;
    const bool is_put_out = (work.is_stored && needs_table(plan.site_data)) ||
                            needs_table(plan.event) || (is_shown && needs_table(plan.display));
    is_looked_up |= is_put_out && !is_kept;
    work.is_told = has(inputs, layer) || (is_kept && is_put_out);
    work.is_fetched = work.is_stored || (work.is_told && !is_constant(plan.lut)) ||
                      !is_constant(plan.event) || is_shown;
  }
  is_looked_up_[i] = is_looked_up;
}

}  // namespace thimble::sim::cam
