#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sim/model/cam/engine/engine.hpp"

namespace thimble::sim::cam {

// What one step does to a site, after the kicks: 16 bits to 16 bits, the same for every site.
using SiteFunction = std::uint32_t (*)(std::uint32_t site);

// A rule as a program of a CAM: what is kicked, step by step and over again, and one table.
// Sizes along x and y that are even, where cells of a checkerboard or of blocks are told apart.
struct Rule {
  std::string_view name;
  std::string_view about;
  SiteFunction function;
  std::vector<std::vector<PlaneKick>>
      cycle;  // the kicks of step n are those of n modulo its length

  // How a world begins. The matter is layers of their own that are filled at random, or one cell of
  // which they are copies; a pattern sets all of a site's.
  LayerBits matter{0};
  bool is_one_cell{false};
  double fill_fraction{0.5};  // of the matter, where there is no pattern
  LayerBits noise{0};         // random bits that the rule draws upon
  LayerBits checker{0};       // set where x + y + z is odd
  // Where matter grows from: the site in the middle, or a pattern.
  LayerBits crystal{0};
  bool is_of_blocks{false};  // a site is 2 x 2 cells: layers 0 to 3 are (0,0) (1,0) (0,1) (1,1)

  // What is seen and felt of a site, where it is not of blocks: what grows rather than what it
  // grows from.
  [[nodiscard]] LayerBits visible_layers() const noexcept {
    return crystal != 0 ? crystal : matter;
  }
};

// All of them, by name.
[[nodiscard]] std::span<const Rule> rules();
// Null when there is none.
[[nodiscard]] const Rule* find_rule(std::string_view name);

[[nodiscard]] std::vector<std::uint16_t> table_of(SiteFunction function);
[[nodiscard]] std::vector<std::uint16_t> table_of(const Rule& rule);

// By what they are of, for rules().
void add_counting_rules(std::vector<Rule>& to);
void add_gas_rules(std::vector<Rule>& to);
void add_block_rules(std::vector<Rule>& to);
void add_spin_rules(std::vector<Rule>& to);

}  // namespace thimble::sim::cam
