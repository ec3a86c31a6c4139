#include "sim/model/cam/rules/random_sites.hpp"

#include <random>

namespace thimble::sim::cam {
namespace {

void set(std::uint16_t& site, LayerBits bits) { site = static_cast<std::uint16_t>(site | bits); }

// x + y + z is odd.
bool is_odd(const SiteSpace& space, std::size_t index) {
  const auto& log2 = space.log2_cells;
  const std::size_t row = index >> log2[0];
  return ((index ^ row ^ row >> log2[1]) & 1) != 0;
}

// Bits of their own for each layer that is asked for, so that what one is filled with does not
// depend on others. The generator's own bits: distributions differ between libraries.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  bool falls(double chance) { return static_cast<double>(random_() >> 11) < chance * 0x1p53; }
  LayerBits layers(LayerBits of, double chance) {
    std::uint32_t bits = 0;
    for (unsigned layer = 0; layer < 16; ++layer) {
      if ((of >> layer & 1) != 0 && falls(chance)) bits |= 1U << layer;
    }
    return static_cast<LayerBits>(bits);
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace

std::array<std::size_t, 3> cells_of(const Rule& rule, const SiteSpace& space) {
  const std::size_t a_site = rule.is_of_blocks ? 2 : 1;
  return {a_site << space.log2_cells[0], a_site << space.log2_cells[1],
          std::size_t{1} << space.log2_cells[2]};
}

void set_cell(const Rule& rule, const SiteSpace& space, std::vector<std::uint16_t>& sites,
              const std::array<std::size_t, 3>& cell) {
  const std::size_t half = rule.is_of_blocks ? 1 : 0;
  const std::size_t row = cell[2] << space.log2_cells[1] | cell[1] >> half;
  std::uint16_t& site = sites[row << space.log2_cells[0] | cell[0] >> half];
  if (rule.is_of_blocks) {
    set(site, static_cast<LayerBits>(1U << ((cell[0] & 1) | (cell[1] & 1) << 1)));
  } else {
    set(site, rule.visible_layers());
  }
}

std::vector<std::uint16_t> random_sites(const Rule& rule, const SiteSpace& space,
                                        const Beginning& beginning) {
  std::vector<std::uint16_t> sites(space.sites());
  Dice dice(beginning.seed);
  const double fraction = beginning.fill_fraction.value_or(rule.fill_fraction);
  const bool is_filled = !beginning.is_for_pattern || rule.crystal != 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    set(sites[i], dice.layers(rule.noise, 0.5));
    if (is_odd(space, i)) set(sites[i], rule.checker);
    if (!is_filled) continue;
    if (rule.is_one_cell) {
      if (dice.falls(fraction)) set(sites[i], rule.matter);
    } else {
      set(sites[i], dice.layers(rule.matter, fraction));
    }
  }
  if (rule.crystal != 0 && !beginning.is_for_pattern) {
    const auto cells = cells_of(rule, space);
    set_cell(rule, space, sites, {cells[0] / 2, cells[1] / 2, cells[2] / 2});
  }
  return sites;
}

}  // namespace thimble::sim::cam
