#include "sim/model/cam/plane_step.hpp"

#include <algorithm>

namespace thimble::sim::cam {
namespace {

using cambus::kLayers;
namespace field = cambus::field;

constexpr WordBlock filled(Word with) {
  WordBlock block;
  for (Word& word : block.words) word = with;
  return block;
}
constexpr WordBlock kZeros = filled(0);
constexpr WordBlock kOnes = filled(~Word{0});
// Bit n: bit k of n.
constexpr std::array<Word, 6> kBitsOfIndex{0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc,
                                           0xf0f0f0f0f0f0f0f0, 0xff00ff00ff00ff00,
                                           0xffff0000ffff0000, 0xffffffff00000000};

bool has(LayerBits layers, std::size_t layer) { return (layers >> layer & 1) != 0; }

}  // namespace

void PlaneStep::visit(std::uint64_t first, std::size_t words, const LayerWords& host) {
  words_ = words;
  for (std::size_t order = 0; order < sites_.size(); ++order) {
    sites_[order] =
        parts_.plan.orders[order].sites(first, std::span(parts_.rooms.sites[order]).first(words));
  }
  for (std::size_t i = 0; i < work_.size(); ++i) fetch(i);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      if (may_cross_[layer][axis]) glue(layer, axis);
    }
  }
  for (std::size_t i = 0; i < work_.size(); ++i) work(i, host);
}

void PlaneStep::fetch(std::size_t i) {
  StepRooms::OfModule& room = parts_.rooms.modules[i];
  const PlaneDram& dram = parts_.drams[parts_.which[i]];
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    if (!work_[i][layer].is_fetched) continue;
    const LayerPlan& plan = parts_.plan.modules[i].layers[layer];
    room.unglued[layer] =
        dram.fetch(layer, plan.placement, sites_[plan.order], room.fetched[layer].words.data());
    room.glued[layer] = room.unglued[layer];
  }
}

// All modules hand over what they have so far, then take what they are to.
void PlaneStep::glue(std::size_t layer, std::size_t axis) {
  std::array<bool, cambus::kMaxModules> takes{};
  for (std::size_t i = 0; i < work_.size(); ++i) takes[i] = take(i, layer, axis);
  for (std::size_t i = 0; i < work_.size(); ++i) {
    if (!takes[i]) continue;
    StepRooms::OfModule& room = parts_.rooms.modules[i];
    room.after[layer] = parts_.rooms.taken[i];
    room.glued[layer] = room.after[layer].words.data();
  }
}

bool PlaneStep::take(std::size_t i, std::size_t layer, std::size_t axis) {
  const LayerPlan& plan = parts_.plan.modules[i].layers[layer];
  const Crossing& crossing = plan.crossings[axis];
  if (!crossing.is_possible()) return false;
  const auto sites = sites_[plan.order].words;
  std::array<Word, kBlockWords> crosses{};
  Word any = 0;
  for (std::size_t k = 0; k < words_; ++k) any |= crosses[k] = crossing.of(sites[k]);
  if (any == 0) return false;
  const Wires& wires = wires_[i][layer][axis];
  const Word* const own = parts_.rooms.modules[i].glued[layer];
  WordBlock& out = parts_.rooms.taken[i];
  for (std::size_t k = 0; k < words_; ++k) {
    Word value = wires.constant;
    for (const std::size_t other : wires.others) {
      value |= parts_.rooms.modules[other].glued[layer][k];
    }
    out.words[k] = (own[k] & ~crosses[k]) | (value & crosses[k]);
  }
  return true;
}

const Word* PlaneStep::address_bit(const LayerPlan& layer, Word* room) const {
  if (layer.address_bit >= cambus::kAddressBits) return kZeros.words.data();
  for (std::size_t k = 0; k < words_; ++k) {
    const std::uint32_t site = sites_[layer.order].words[k];
    room[k] = layer.address_bit < kBitsOfIndex.size() ? kBitsOfIndex[layer.address_bit]
              : (site >> layer.address_bit & 1) != 0  ? ~Word{0}
                                                      : 0;
  }
  return room;
}

const Word* PlaneStep::evaluate(const PlaneSource& source, std::size_t i, std::size_t layer,
                                const LayerWords& host, const Word* fourth, Word* room) const {
  if (source.map == cambus::kMapZero) return kZeros.words.data();
  if (source.map == cambus::kMapOne) return kOnes.words.data();
  const StepRooms::OfModule& of = parts_.rooms.modules[i];
  const Word* const glued = of.glued[layer];
  if (source.map == cambus::kMapSite) return glued;
  // Nothing is on the flywheel.
  const LayerWords::value_type selected =
      source.select == cambus::kSelectUnglued    ? of.unglued[layer]
      : source.select == cambus::kSelectHost     ? host[layer]
      : source.select == cambus::kSelectFlywheel ? kZeros.words.data()
                                                 : fourth;
  if (source.map == cambus::kMapSource) return selected;
  const auto all_if = [&](unsigned bit) { return (source.map >> bit & 1U) != 0 ? ~Word{0} : 0; };
  const std::array<Word, 4> map{all_if(0), all_if(1), all_if(2), all_if(3)};
  for (std::size_t k = 0; k < words_; ++k) {
    const Word s = selected[k];
    const Word g = glued[k];
    room[k] = (~s & ~g & map[0]) | (~s & g & map[1]) | (s & ~g & map[2]) | (s & g & map[3]);
  }
  return room;
}

// What comes out of the table, of those layers that somebody looks at.
LayerWords PlaneStep::look_up(std::size_t i, const LayerWords& host) {
  const PreparedTable& table = *parts_.tables[i];
  StepRooms& rooms = parts_.rooms;
  const std::size_t extra = table.rule ? table.rule->rooms : 0;
  if (rooms.rule.size() < extra) rooms.rule.resize(extra);
  rooms.places.resize(PlaneRule::kFirstRoom + rooms.rule.size());
  LayerWords told{};
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    told[layer] = kZeros.words.data();
    Word* const output = rooms.output[layer].words.data();
    rooms.places[PlaneRule::kFirstOutput + layer] = output;
    if (work_[i][layer].is_told) {
      const LayerPlan& plan = parts_.plan.modules[i].layers[layer];
      // The output's room is free until the table is looked up.
      const Word* const fourth = plan.lut.select == cambus::kSelectLutOrAddress
                                     ? address_bit(plan, output)
                                     : kZeros.words.data();
      const Word* const entry =
          evaluate(plan.lut, i, layer, host, fourth, rooms.entry[layer].words.data());
      told[layer] = entry;
      if (entry == output) {
        rooms.entry[layer] = rooms.output[layer];
        told[layer] = rooms.entry[layer].words.data();
      }
    }
    rooms.places[layer] = const_cast<Word*>(told[layer]);  // nothing writes to an input
  }
  for (std::size_t room = 0; room < rooms.rule.size(); ++room) {
    rooms.places[PlaneRule::kFirstRoom + room] = rooms.rule[room].words.data();
  }
  Word* const* const out = rooms.places.data() + PlaneRule::kFirstOutput;
  if (is_looked_up_[i] && table.rule) {
    parts_.kernels.run_ops(table.rule->ops.data(), table.rule->ops.size(), rooms.places.data());
  } else if (is_looked_up_[i]) {
    parts_.kernels.apply_table(rooms.places.data(), table.entries.data(), out);
  }
  LayerWords outputs{};
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    outputs[layer] = has(table.shape.kept, layer) ? told[layer]
                     : table.rule                 ? out[table.rule->same_as[layer]]
                                                  : out[layer];
  }
  return outputs;
}

void PlaneStep::work(std::size_t i, const LayerWords& host) {
  const LayerWords output = look_up(i, host);
  for (std::size_t layer = 0; layer < kLayers; ++layer) work_on(i, layer, host, output[layer]);
}

void PlaneStep::work_on(std::size_t i, std::size_t layer, const LayerWords& host,
                        const Word* output) {
  const LayerPlan& plan = parts_.plan.modules[i].layers[layer];
  StepRooms& rooms = parts_.rooms;
  Work& work = work_[i][layer];
  Word* const room = rooms.data[layer].words.data();
  if (plan.event.map != cambus::kMapZero) {
    const Word* const all = evaluate(plan.event, i, layer, host, output, room);
    const Word* const events = where_visited(all, kZeros.words.data(), room);
    work.events += parts_.kernels.count_ones(events, words_);
  }
  if (parts_.looked_at == i) {
    std::copy_n(evaluate(plan.display, i, layer, host, output, room), words_,
                rooms.shown[layer].words.begin());
  }
  if (work.is_stored) {
    const Word* const old = rooms.modules[i].unglued[layer];
    const Word* const all = evaluate(plan.site_data, i, layer, host, output, room);
    parts_.drams[parts_.which[i]].store(layer, plan.placement, sites_[plan.order], old,
                                        where_visited(all, old, room), work.ones);
  }
}

const Word* PlaneStep::where_visited(const Word* words, const Word* others, Word* room) const {
  if (visited_ == ~Word{0}) return words;
  for (std::size_t k = 0; k < words_; ++k) {
    room[k] = (words[k] & visited_) | (others[k] & ~visited_);
  }
  return room;
}

void PlaneStep::finish(CamTorus& torus, std::uint64_t visits) {
  for (std::size_t i = 0; i < work_.size(); ++i) {
    CamModule& module = torus.modules[parts_.which[i]];
    module.registers.add(field::kScanIndex[0], static_cast<std::uint32_t>(visits));
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const Work& work = work_[i][layer];
      module.event_counters[layer] = static_cast<std::uint32_t>(
          (module.event_counters[layer] + work.events) & ((1U << cambus::kEventBits) - 1U));
      for (std::size_t half = 0; half < work.ones.size(); ++half) {
        if (work.ones[half] == 0) continue;
        const auto count = module.registers.get(field::kDramCount[half], layer);
        module.registers.set(field::kDramCount[half], layer,
                             count + static_cast<std::uint32_t>(work.ones[half]));
      }
    }
  }
}

}  // namespace thimble::sim::cam
