#include <algorithm>
#include <random>

#include "cli/cam/pattern.hpp"
#include "cli/cam/rules/rule.hpp"
#include "cli/cam/run.hpp"

namespace thimble::cam {
namespace {

using sim::cam::SiteSpace;
using Sites = std::vector<std::uint16_t>;

struct Place {
  std::size_t x, y, z;
};

Place place_of(const SiteSpace& space, std::size_t index) {
  const auto& log2 = space.log2_cells;
  const std::size_t row = index >> log2[0];
  return {index & ((std::size_t{1} << log2[0]) - 1), row & ((std::size_t{1} << log2[1]) - 1),
          row >> log2[1]};
}

// Cells along each axis: twice the sites where a site is a block.
std::array<std::size_t, 3> cells_of(const Rule& rule, const SiteSpace& space) {
  const std::size_t a_site = rule.is_of_blocks ? 2 : 1;
  return {a_site << space.log2_cells[0], a_site << space.log2_cells[1],
          std::size_t{1} << space.log2_cells[2]};
}

void set(std::uint16_t& site, LayerBits bits) { site = static_cast<std::uint16_t>(site | bits); }

// Cell (x, y, z) of the space, in the site and the layers that it is.
void set_cell(const Rule& rule, const SiteSpace& space, Sites& sites, const Place& cell) {
  const std::size_t half = rule.is_of_blocks ? 1 : 0;
  const std::size_t x = cell.x >> half;
  const std::size_t y = cell.y >> half;
  const std::size_t row = cell.z << space.log2_cells[1] | y;
  std::uint16_t& site = sites[row << space.log2_cells[0] | x];
  if (rule.is_of_blocks) {
    set(site, static_cast<LayerBits>(1U << ((cell.x & 1) | (cell.y & 1) << 1)));
  } else {
    set(site, rule.crystal != 0 ? rule.crystal : rule.matter);
  }
}

// In the middle of the space.
Result<void> put_pattern(const Rule& rule, const SiteSpace& space, const Pattern& pattern,
                         Sites& sites) {
  const auto cells = cells_of(rule, space);
  std::array<std::size_t, 3> first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (pattern.size[axis] > cells[axis]) {
      return fail(Errc::InvalidArgument, "the pattern is larger than the space");
    }
    first[axis] = (cells[axis] - pattern.size[axis]) / 2;
  }
  for (std::size_t i = 0; i < pattern.cells.size(); ++i) {
    if (!pattern.cells[i]) continue;
    const std::size_t row = i / pattern.size[0];
    set_cell(rule, space, sites,
             {first[0] + i % pattern.size[0], first[1] + row % pattern.size[1],
              first[2] + row / pattern.size[1]});
  }
  return {};
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

Result<Sites> first_sites(const Rule& rule, const SiteSpace& space, const RunOptions& options) {
  Sites sites(space.sites());
  Dice dice(options.seed);
  const bool is_filled = options.pattern.empty() || rule.crystal != 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Place place = place_of(space, i);
    set(sites[i], dice.layers(rule.noise, 0.5));
    if ((place.x + place.y + place.z) % 2 != 0) set(sites[i], rule.checker);
    if (!is_filled) continue;
    if (rule.is_one_cell) {
      if (dice.falls(rule.fill_fraction)) set(sites[i], rule.matter);
    } else {
      set(sites[i], dice.layers(rule.matter, rule.fill_fraction));
    }
  }
  if (options.pattern.empty()) {
    if (rule.crystal != 0) {
      const auto cells = cells_of(rule, space);
      set_cell(rule, space, sites, {cells[0] / 2, cells[1] / 2, cells[2] / 2});
    }
    return sites;
  }
  const auto pattern = read_pattern(options.pattern);
  if (!pattern) return tl::unexpected(pattern.error());
  if (const auto put = put_pattern(rule, space, *pattern, sites); !put) {
    return tl::unexpected(put.error().in(options.pattern));
  }
  return sites;
}

}  // namespace thimble::cam
