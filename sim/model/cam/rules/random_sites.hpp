#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/model/cam/rules/rule.hpp"

namespace thimble::sim::cam {

// How a world begins. Same numbers, same sites, on every machine.
struct Beginning {
  std::uint64_t seed{1};
  std::optional<double> fill_fraction{};  // else the rule's
  // Where somebody brings a pattern: no matter but what feeds a crystal, and no first crystal.
  bool is_for_pattern{false};
};

// A world's first sites: matter at random, noise, the checkerboard, and in the middle what a
// crystal grows from. Pure.
[[nodiscard]] std::vector<std::uint16_t> random_sites(const Rule& rule, const SiteSpace& space,
                                                      const Beginning& beginning);

// Cells along each axis: twice the sites where a site is a block.
[[nodiscard]] std::array<std::size_t, 3> cells_of(const Rule& rule, const SiteSpace& space);
// Sets cell (x, y, z) of the space, in the site and the layers that it is; of a rule with a crystal
// that. A cell that is not there is a mistake of the caller.
void set_cell(const Rule& rule, const SiteSpace& space, std::vector<std::uint16_t>& sites,
              const std::array<std::size_t, 3>& cell);

}  // namespace thimble::sim::cam
