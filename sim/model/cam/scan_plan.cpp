#include "sim/model/cam/scan_plan.hpp"

#include <algorithm>
#include <bit>

#include "drivers/cambus/cambus_wire.hpp"

namespace thimble::sim::cam {
namespace {

using cambus::Field;
using cambus::kAddressBits;
using cambus::kLayers;
using cambus::Register;
namespace field = cambus::field;
namespace wire = cambus::wire;

constexpr std::uint32_t kInWord = kWordSites - 1;
constexpr unsigned kLog2Word = 6;
constexpr std::uint32_t kAddresses = 1U << kAddressBits;
using ByLayer = CamRegisters::ByLayer;

std::array<PlaneSource, kLayers> sources(const CamRegisters& registers,
                                         const std::array<Field, 2>& of) {
  const ByLayer select = registers.by_layer(of[0]);
  const ByLayer map = registers.by_layer(of[1]);
  std::array<PlaneSource, kLayers> sources{};
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    sources[layer] = {static_cast<std::uint8_t>(select[layer]),
                      static_cast<std::uint8_t>(map[layer])};
  }
  return sources;
}

void plan_sources(const CamRegisters& registers, ModulePlan& plan) {
  const auto lut = sources(registers, field::kSource<Register::LutSrc>);
  const auto site = sources(registers, field::kSource<Register::SiteSrc>);
  const auto event = sources(registers, field::kSource<Register::EventSrc>);
  const auto display = sources(registers, field::kSource<Register::Display>);
  const ByLayer address_bit = registers.by_layer(field::kSaBit[0]);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    LayerPlan& of = plan.layers[layer];
    of.lut = lut[layer];
    of.site_data = site[layer];
    of.event = event[layer];
    of.display = display[layer];
    of.address_bit = address_bit[layer];
  }
}

void plan_movement(const CamRegisters& registers, int log2_sites, ModulePlan& plan) {
  const ByLayer offset = registers.by_layer(field::kOffset[0]);
  const ByLayer cuts = registers.by_layer(field::kCuts);
  const ByLayer kick = registers.by_layer(field::kKickAmount);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    plan.layers[layer].placement = Placement(offset[layer], cuts[layer], log2_sites);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const ByLayer pointer = registers.by_layer(field::kDimension[1 + axis]);
    const ByLayer is_minus = registers.by_layer(field::kKick[1 + axis]);
    const ByLayer is_most = registers.by_layer(field::kKick[4 + axis]);
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      LayerPlan& of = plan.layers[layer];
      of.is_minus[axis] = is_minus[layer] != 0;
      of.crossings[axis] = Crossing(pointer[layer], kick[layer], cuts[layer], is_minus[layer] != 0,
                                    is_most[layer] != 0);
    }
  }
}

void plan_wires(const CamRegisters& registers, ModulePlan& plan) {
  for (std::size_t pin = 0; pin < kPins; ++pin) {
    const ByLayer codes = registers.by_layer(field::kConnect[pin]);
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      plan.layers[layer].connections[pin] = codes[layer];
    }
  }
}

// All that a plan is made of but the wires.
bool say_the_same(const CamRegisters& a, const CamRegisters& b) {
  constexpr std::array kAsked{Register::Kick,     Register::SaBit,     Register::LutSrc,
                              Register::SiteSrc,  Register::EventSrc,  Register::Display,
                              Register::Offset,   Register::ScanIndex, Register::ScanPerm,
                              Register::Dimension};
  return std::all_of(kAsked.begin(), kAsked.end(),
                     [&](Register of) { return a.planes(of) == b.planes(of); });
}

void plan_order(const CamRegisters& registers, ScanPlan& scan, ModulePlan& plan) {
  std::array<ByLayer, kAddressBits> permuters{};
  for (std::size_t bit = 0; bit < kAddressBits; ++bit) {
    permuters[bit] = registers.by_layer(field::kScanPerm[bit]);
  }
  const ByLayer index = registers.by_layer(field::kScanIndex[0]);
  std::array<std::uint32_t, kAddressBits> permuter{};
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    for (std::size_t bit = 0; bit < kAddressBits; ++bit) permuter[bit] = permuters[bit][layer];
    const VisitOrder order(permuter, index[layer]);
    const auto found = std::find(scan.orders.begin(), scan.orders.end(), order);
    plan.layers[layer].order = static_cast<std::size_t>(found - scan.orders.begin());
    if (found == scan.orders.end()) scan.orders.push_back(order);
  }
}

ScanPace pace_of(const CamRegisters& format, std::uint64_t sites) {
  ScanPace pace;
  pace.sites_a_sweep = std::min(sites, std::uint64_t{1} << format.get(field::kEndOfSweep, 0));
  pace.sweeps = sites / pace.sites_a_sweep;
  const bool is_fast =
      format.get(field::kScanMode, 0) >= 2 && format.get(field::kEndOfStretch, 0) > 0;
  pace.clocks_a_sweep =
      pace.sites_a_sweep * (is_fast ? 1 : wire::kSlowSite_clocks) + wire::kSweepOverhead_clocks;
  pace.sweeps_a_refresh = std::max(1U, format.get(field::kSweepsBetweenRefresh, 0));
  pace.clocks_a_refresh =
      std::uint64_t{wire::kClocksPerRefresh} * format.get(field::kRefreshLength, 0);
  return pace;
}

}  // namespace

Crossing::Crossing(std::uint32_t pointer, std::uint32_t kick, std::uint32_t cuts, bool is_minus,
                   bool is_most) {
  flip_ = is_minus ? ~Word{0} : 0;
  if (pointer >= kAddressBits) {
    // A pointer to a constant 1 borrows nowhere, any other that is no bit everywhere.
    if (pointer != cambus::kConstant1) flip_ = ~flip_;
  } else {
    // The number of which the pointer is a bit begins behind the cut below it.
    const std::uint32_t below = cuts & ((1U << pointer) - 1U);
    const std::uint32_t first = below == 0 ? 0 : static_cast<std::uint32_t>(std::bit_width(below));
    const std::uint32_t mask = ((2U << pointer) - 1U) & ~((1U << first) - 1U);
    mask_ = mask & ~kInWord;
    kick_ = kick & mask_;
    const std::uint32_t kick_in_word = kick & mask & kInWord;
    for (std::uint32_t site = 0; site < kWordSites; ++site) {
      if ((site & mask) < kick_in_word) of_equal_ |= Word{1} << site;
    }
  }
  if (is_most) {
    mask_ = kick_ = 0;
    of_equal_ = 0;
    flip_ = ~Word{0};
  }
  is_possible_ = flip_ != 0 || kick_ != 0 || of_equal_ != 0;
}

VisitOrder::VisitOrder(const std::array<std::uint32_t, kAddressBits>& permuter, std::uint32_t index)
    : permuter_(permuter), index_(index) {
  std::uint32_t known = 0;
  for (std::uint32_t bit = 0; bit < kAddressBits; ++bit) {
    const std::uint32_t code = permuter_[bit];
    if (code == bit) straight_ |= 1U << bit;
    if (code == cambus::kConstant1) ones_ |= 1U << bit;
    if (code == bit || code >= kAddressBits) known |= 1U << bit;
  }
  is_straight_ = known == kAddresses - 1;
  visited_ = 1;
  for (std::uint32_t bit = 0; bit < kLog2Word; ++bit) {
    const Word further = visited_ << (1U << bit);
    const std::uint32_t code = permuter_[bit];
    if (code < kAddressBits) {
      ++free_;
      visited_ |= further;
    } else if (code == cambus::kConstant1) {
      visited_ = further;
    }
  }
}

bool VisitOrder::goes_in_words(std::uint64_t visits, int log2_sites) const noexcept {
  const bool is_whole =
      visits > 0 && visits % sites_of_word() == 0 && index_ % sites_of_word() == 0;
  if (!is_whole || index_ + visits > kAddresses) return false;
  std::uint32_t told = 0;     // index bits that some address bit within the DRAM is
  std::uint32_t in_word = 0;  // or one within a word
  for (std::uint32_t bit = 0; bit < kAddressBits; ++bit) {
    const std::uint32_t code = permuter_[bit];
    if (code >= kAddressBits) continue;
    // The fastest index bits, and no others, go through a word.
    if ((bit < kLog2Word) != (code < free_)) return false;
    if (bit < kLog2Word) in_word |= 1U << code;
    if (bit < static_cast<std::uint32_t>(log2_sites)) told |= 1U << code;
  }
  if (in_word != (1U << free_) - 1U) return false;
  const auto last = static_cast<std::uint32_t>(index_ + visits - 1);
  const std::uint32_t varying = (1U << std::bit_width(index_ ^ last)) - 1U;
  return (varying & ~told) == 0;
}

bool VisitOrder::is_alike_in_words(const VisitOrder& other) const noexcept {
  return std::equal(permuter_.begin(), permuter_.begin() + kLog2Word, other.permuter_.begin());
}

bool VisitOrder::is_in_turn_in_words() const noexcept { return (straight_ & kInWord) == kInWord; }

SiteWords VisitOrder::sites(std::uint64_t first, std::span<std::uint32_t> out) const noexcept {
  auto index = static_cast<std::uint32_t>(index_ + first);
  const std::uint32_t begin = index;
  for (std::uint32_t& site : out) {
    site = ((index & straight_) | ones_) & ~kInWord;
    if (!is_straight_) {
      for (std::uint32_t bit = kLog2Word; bit < kAddressBits; ++bit) {
        const std::uint32_t code = permuter_[bit];
        if (code != bit && code < kAddressBits) site |= (index >> code & 1U) << bit;
      }
    }
    index += static_cast<std::uint32_t>(sites_of_word());
  }
  const auto length = static_cast<std::uint32_t>(out.size() * kWordSites);
  const bool is_power = std::has_single_bit(length);
  return {out, is_straight_ && is_power && (straight_ & (length - 1)) == length - 1 &&
                   begin % length == 0};
}

ScanPlan plan_scan(const CamTorus& torus, std::span<const std::size_t> which) {
  ScanPlan scan;
  scan.modules.reserve(which.size());
  const CamRegisters* before = nullptr;
  for (const std::size_t i : which) {
    const CamModule& module = torus.modules[i];
    const bool is_again = before != nullptr && say_the_same(*before, module.registers);
    ModulePlan plan = is_again ? scan.modules.back() : ModulePlan{};
    if (!is_again) {
      plan_sources(module.registers, plan);
      plan_movement(module.registers, std::countr_zero(module.dram.size()), plan);
      plan_order(module.registers, scan, plan);
    }
    plan_wires(module.registers, plan);
    scan.modules.push_back(plan);
    before = &module.registers;
  }
  const CamRegisters& format = torus.modules[which.front()].registers;
  const std::uint32_t end = format.get(field::kEndOfScan, 0);
  scan.sites = std::uint64_t{1} << std::min<std::uint32_t>(end, kAddressBits);
  scan.pace = pace_of(format, scan.sites);
  return scan;
}

}  // namespace thimble::sim::cam
