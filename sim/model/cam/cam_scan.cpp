#include "sim/model/cam/cam_scan.hpp"

#include <algorithm>
#include <array>

#include "drivers/cambus/cambus_wire.hpp"

namespace thimble::sim::cam {
namespace {

using cambus::Register;
namespace field = cambus::field;
namespace wire = cambus::wire;

constexpr std::uint32_t kIndexBits = cambus::kAddressBits;  // no scan is longer than its index

std::uint32_t bit_of(std::uint32_t value, std::size_t bit) { return (value >> bit) & 1U; }

// A destination's source register, decoded.
struct Source {
  std::uint32_t select{0};
  std::uint32_t map{0};

  [[nodiscard]] std::uint32_t pick(std::uint32_t selected, std::uint32_t glued) const {
    return bit_of(map, 2 * selected + glued);
  }
};

template <Register R>
Source source_of(const CamModule& module, std::size_t layer) {
  const auto& fields = field::kSource<R>;
  return {module.registers.get(fields[0], layer), module.registers.get(fields[1], layer)};
}

// What does not change during a scan, of one layer of one module.
struct Layer {
  Layer(const CamModule& module, std::size_t layer);
  [[nodiscard]] std::uint32_t site_address() const;
  // By axis. `site` is the site address.
  [[nodiscard]] std::array<bool, 3> crossings(std::uint32_t site) const;

  std::array<std::uint32_t, cambus::kAddressBits> permuter{};
  std::array<std::uint32_t, 3> pointer{};
  std::array<bool, 3> is_minus{};
  std::array<bool, 3> is_most{};
  std::array<std::uint32_t, kPins> connections{};
  std::uint32_t index, offset, cuts, kick, address_bit;
  Source lut, site_data, event, display;
};

Layer::Layer(const CamModule& module, std::size_t layer)
    : index(module.registers.get(field::kScanIndex[0], layer)),
      offset(module.registers.get(field::kOffset[0], layer)),
      cuts(module.registers.get(field::kCuts, layer)),
      kick(module.registers.get(field::kKickAmount, layer)),
      address_bit(module.registers.get(field::kSaBit[0], layer)),
      lut(source_of<Register::LutSrc>(module, layer)),
      site_data(source_of<Register::SiteSrc>(module, layer)),
      event(source_of<Register::EventSrc>(module, layer)),
      display(source_of<Register::Display>(module, layer)) {
  for (std::size_t bit = 0; bit < permuter.size(); ++bit) {
    permuter[bit] = module.registers.get(field::kScanPerm[bit], layer);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    pointer[axis] = module.registers.get(field::kDimension[1 + axis], layer);
    is_minus[axis] = module.registers.get(field::kKick[1 + axis], layer) != 0;
    is_most[axis] = module.registers.get(field::kKick[4 + axis], layer) != 0;
  }
  for (std::size_t pin = 0; pin < kPins; ++pin) connections[pin] = connection(module, pin, layer);
}

std::uint32_t Layer::site_address() const {
  std::uint32_t site = 0;
  for (std::size_t bit = 0; bit < permuter.size(); ++bit) {
    const std::uint32_t code = permuter[bit];
    const std::uint32_t value =
        code < cambus::kAddressBits ? bit_of(index, code) : code == cambus::kConstant1;
    site |= value << bit;
  }
  return site;
}

std::array<bool, 3> Layer::crossings(std::uint32_t site) const {
  const std::uint32_t borrows = subtract(site, kick, cuts).borrows;
  std::array<bool, 3> crosses{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t code = pointer[axis];
    const bool has_borrowed =
        code < cambus::kAddressBits ? bit_of(borrows, code) != 0 : code != cambus::kConstant1;
    crosses[axis] = is_most[axis] || has_borrowed != is_minus[axis];
  }
  return crosses;
}

// One layer of one module at one moment.
struct Bit {
  std::uint32_t site{0};
  std::uint32_t address{0};
  std::uint32_t unglued{0};
  std::uint32_t glued{0};
  std::array<bool, 3> crosses{};
};

class Lockstep {
 public:
  Lockstep(CamTorus& torus, std::span<const std::size_t> which);
  // One site of each module; `host` is what the host says. Returns what one of them shows.
  std::uint16_t visit(std::uint16_t host, std::size_t looked_at = 0);
  // Leaves the scan indices where the scan has come to.
  void finish();

 private:
  void fetch(std::size_t i);
  void glue(std::size_t layer, std::size_t axis);
  [[nodiscard]] std::uint32_t taken(std::size_t i, std::size_t layer, std::size_t axis) const;
  std::uint16_t work(std::size_t i, std::uint16_t host);

  CamTorus& torus_;
  std::vector<std::size_t> which_;
  std::vector<std::size_t> place_;  // of a module in which_; or beyond it
  std::vector<std::array<Bit, cambus::kLayers>> bits_;
  std::vector<std::vector<Layer>> layers_;
  std::vector<std::uint32_t> after_;
};

Lockstep::Lockstep(CamTorus& torus, std::span<const std::size_t> which)
    : torus_(torus),
      which_(which.begin(), which.end()),
      place_(torus.size(), which.size()),
      bits_(which.size()),
      layers_(which.size()),
      after_(which.size()) {
  for (std::size_t i = 0; i < which_.size(); ++i) {
    place_[which_[i]] = i;
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
      layers_[i].emplace_back(torus_.modules[which_[i]], layer);
    }
  }
}

std::uint16_t Lockstep::visit(std::uint16_t host, std::size_t looked_at) {
  for (std::size_t i = 0; i < which_.size(); ++i) fetch(i);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) glue(layer, axis);
  }
  std::uint16_t shown = 0;
  for (std::size_t i = 0; i < which_.size(); ++i) {
    const std::uint16_t of_module = work(i, host);
    if (i == looked_at) shown = of_module;
  }
  return shown;
}

void Lockstep::fetch(std::size_t i) {
  const CamModule& module = torus_.modules[which_[i]];
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    const Layer& plan = layers_[i][layer];
    Bit& bit = bits_[i][layer];
    bit.site = plan.site_address();
    const auto last = static_cast<std::uint32_t>(module.dram.size() - 1);
    bit.address = add(bit.site, plan.offset, plan.cuts) & last;
    bit.unglued = bit_of(module.dram[bit.address], layer);
    bit.glued = bit.unglued;
    bit.crosses = plan.crossings(bit.site);
  }
}

// All modules hand over what they have so far, then take what they are to.
void Lockstep::glue(std::size_t layer, std::size_t axis) {
  for (std::size_t i = 0; i < which_.size(); ++i) {
    const Bit& bit = bits_[i][layer];
    after_[i] = bit.crosses[axis] ? taken(i, layer, axis) : bit.glued;
  }
  for (std::size_t i = 0; i < which_.size(); ++i) bits_[i][layer].glued = after_[i];
}

// Data goes out of the port on the side that the sign says and comes in by the other one: from
// every pin that is connected to it, ORed.
std::uint32_t Lockstep::taken(std::size_t i, std::size_t layer, std::size_t axis) const {
  const Layer& here = layers_[i][layer];
  const std::size_t in_port = 2 * axis + (here.is_minus[axis] ? 1 : 0);
  std::uint32_t value = 0;
  for (std::size_t pin = 0; pin < kPins; ++pin) {
    if (here.connections[pin] != in_port) continue;
    const std::size_t other = place_[torus_.neighbor(which_[i], pin)];
    if (other == which_.size()) return 1;  // it does not scan: nobody drives the wire
    const Layer& there = layers_[other][layer];
    const std::uint32_t code = there.connections[CamTorus::opposite(pin)];
    const std::size_t out_port = 2 * axis + (there.is_minus[axis] ? 0 : 1);
    if (code == out_port) {
      value |= bits_[other][layer].glued;
    } else {
      value |= code == cambus::kPinIs0 ? 0U : 1U;  // undriven wires are pulled up
    }
  }
  return value;
}

// From the bits to the table, and back to where each came from.
std::uint16_t Lockstep::work(std::size_t i, std::uint16_t host) {
  CamModule& module = torus_.modules[which_[i]];
  const auto selected = [&](const Source& source, std::size_t layer, std::uint32_t fourth) {
    const std::array<std::uint32_t, 4> sources{bits_[i][layer].unglued, bit_of(host, layer), 0,
                                               fourth};  // nothing is on the flywheel
    return source.pick(sources[source.select], bits_[i][layer].glued);
  };
  std::uint32_t entry = 0;
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    const Layer& plan = layers_[i][layer];
    entry |= selected(plan.lut, layer, bit_of(bits_[i][layer].site, plan.address_bit)) << layer;
  }
  const std::uint32_t output = module.active_table()[entry];
  std::uint32_t shown = 0;
  for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
    Layer& plan = layers_[i][layer];
    const std::uint32_t of_table = bit_of(output, layer);
    module.store(layer, bits_[i][layer].address, selected(plan.site_data, layer, of_table) != 0);
    module.event_counters[layer] += selected(plan.event, layer, of_table);
    module.event_counters[layer] &= (1U << cambus::kEventBits) - 1U;
    shown |= selected(plan.display, layer, of_table) << layer;
    ++plan.index;
  }
  return static_cast<std::uint16_t>(shown);
}

void Lockstep::finish() {
  for (std::size_t i = 0; i < which_.size(); ++i) {
    CamRegisters& registers = torus_.modules[which_[i]].registers;
    for (std::size_t layer = 0; layer < cambus::kLayers; ++layer) {
      registers.set(field::kScanIndex[0], layer, layers_[i][layer].index);
    }
  }
}

// From the scan's beginning, as `clocks` is: where the next pulse comes.
std::uint64_t clocks_until_sweep(const ScanSync& sync, std::uint64_t clocks, bool is_first) {
  const std::uint64_t now = sync.now_clocks + clocks;
  const bool waits_for_frame = is_first && sync.mode == cambus::kSyncFrame;
  const std::uint64_t begin =
      waits_for_frame ? sync.pulses.next_frame(now) : sync.pulses.next_line(now);
  return begin - sync.now_clocks;
}

}  // namespace

bool shows_scan(const CamModule& module) noexcept {
  return module.registers.get(field::kShowScan[0], 0) != 0;
}

std::optional<std::size_t> module_on_video(const CamTorus& torus,
                                           std::span<const std::size_t> which) {
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (shows_scan(torus.modules[which[i]])) return i;
  }
  return std::nullopt;
}

std::uint64_t scan(CamTorus& torus, std::span<const std::size_t> which, bool moves_bits,
                   const ScanSync* sync) {
  if (which.empty()) return 0;
  const CamRegisters& format = torus.modules[which.front()].registers;
  const std::uint32_t end_of_scan = format.get(field::kEndOfScan, 0);
  const std::uint64_t sites = std::uint64_t{1} << std::min(end_of_scan, kIndexBits);
  const std::uint64_t sweep =
      std::min(sites, std::uint64_t{1} << format.get(field::kEndOfSweep, 0));
  const bool is_fast =
      format.get(field::kScanMode, 0) >= 2 && format.get(field::kEndOfStretch, 0) > 0;
  const std::uint64_t sweeps_between = std::max(1U, format.get(field::kSweepsBetweenRefresh, 0));
  const std::uint64_t refreshes = format.get(field::kRefreshLength, 0);
  const auto on_video = module_on_video(torus, which);
  std::uint64_t clocks = 0;
  std::uint64_t sweeps = 0;
  Lockstep modules(torus, which);
  std::vector<std::uint16_t> line;
  for (std::uint64_t visited = 0; visited < sites; visited += sweep) {
    if (sync != nullptr) clocks = clocks_until_sweep(*sync, clocks, sweeps == 0);
    const std::uint64_t began = clocks;
    line.clear();
    for (std::uint64_t site = 0; site < sweep; ++site) {
      const std::uint16_t shown = moves_bits ? modules.visit(0, on_video.value_or(0)) : 0;
      if (sync != nullptr) line.push_back(shown);
      clocks += is_fast ? 1 : wire::kSlowSite_clocks;
    }
    if (sync != nullptr && on_video && moves_bits) {
      sync->monitor.draw(sync->pulses.place_of(sync->now_clocks + began), line);
    }
    clocks += wire::kSweepOverhead_clocks;
    if (++sweeps % sweeps_between == 0) clocks += wire::kClocksPerRefresh * refreshes;
  }
  if (moves_bits) modules.finish();
  return clocks;
}

std::vector<std::uint16_t> scan_io(CamTorus& torus, std::size_t module,
                                   std::span<const std::uint16_t> told) {
  const std::array<std::size_t, 1> which{module};
  Lockstep modules(torus, which);
  std::vector<std::uint16_t> shown(told.size());
  std::transform(told.begin(), told.end(), shown.begin(),
                 [&](std::uint16_t word) { return modules.visit(word); });
  modules.finish();
  return shown;
}

}  // namespace thimble::sim::cam
