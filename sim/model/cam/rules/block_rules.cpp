#include <bit>

#include "sim/model/cam/rules/rule.hpp"

// Blocks of 2 x 2 cells (Margolus neighbourhood): a site is a block, and kicks regroup the cells to
// the blocks that lie across, and back. Across, a layer's cell is the one opposite; each of these
// rules is the same turned by 180 degrees, so that one table does for both.
namespace thimble::sim::cam {
namespace {

constexpr std::uint32_t kBlock = 0xf;
constexpr std::uint32_t kPhase = 0x10;
constexpr std::uint32_t kChance = 0x20;

const std::vector<PlaneKick> kAcross{
    {1, {-1, -1, 0}}, {2, {0, -1, 0}}, {4, {-1, 0, 0}}, {kChance, {1, 2, 0}}};
const std::vector<PlaneKick> kBack{
    {1, {1, 1, 0}}, {2, {0, 1, 0}}, {4, {1, 0, 0}}, {kChance, {1, 1, 0}}};

std::uint32_t others(std::uint32_t site) { return site & ~kBlock; }
std::uint32_t opposite(std::uint32_t block) {
  return (block & 1) << 3 | (block & 2) << 1 | (block & 4) >> 1 | (block & 8) >> 3;
}
// (0,0) to (1,0) to (1,1) to (0,1).
std::uint32_t clockwise(std::uint32_t block) {
  return (block & 1) << 1 | (block & 2) << 2 | (block & 8) >> 1 | (block & 4) >> 2;
}
std::uint32_t counter_clockwise(std::uint32_t block) {
  return clockwise(clockwise(clockwise(block)));
}
bool is_diagonal(std::uint32_t block) { return block == 0x9 || block == 0x6; }

// A lone ball flies on, a pair on a diagonal turns to the other one.
std::uint32_t billiard_balls(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  if (std::popcount(block) == 1) return others(site) | opposite(block);
  return is_diagonal(block) ? site ^ kBlock : site;
}

// The complement unless two of four are set; three are turned round besides.
std::uint32_t critters(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  const int count = std::popcount(block);
  if (count == 2) return site;
  const std::uint32_t after = block ^ kBlock;
  return others(site) | (count == 3 ? opposite(after) : after);
}

// Blocks turn one way and the other by turns, unless two meet on a diagonal.
std::uint32_t tm_gas(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  const std::uint32_t turned = (site & kPhase) != 0 ? clockwise(block) : counter_clockwise(block);
  return (is_diagonal(block) ? block : turned) | (others(site) ^ kPhase);
}

std::uint32_t diffusion(std::uint32_t site) {
  const std::uint32_t block = site & kBlock;
  return others(site) | ((site & kChance) != 0 ? clockwise(block) : counter_clockwise(block));
}

Rule block_rule(std::string_view name, std::string_view about, SiteFunction function) {
  return {.name = name,
          .about = about,
          .function = function,
          .cycle = {kAcross, kBack},
          .matter = kBlock,
          .fill_fraction = 0.25,
          .noise = kChance,
          .is_of_blocks = true};
}

}  // namespace

void add_block_rules(std::vector<Rule>& to) {
  to.push_back(block_rule("billiard-balls", "Margolus's billiard balls, blocks of 2 x 2 cells",
                          billiard_balls));
  to.push_back(block_rule("critters", "Critters, blocks of 2 x 2 cells", critters));
  to.push_back(
      block_rule("tm-gas", "the gas of Toffoli and Margolus, blocks of 2 x 2 cells", tm_gas));
  to.push_back(block_rule("diffusion", "blocks of 2 x 2 cells turn at random", diffusion));
}

}  // namespace thimble::sim::cam
