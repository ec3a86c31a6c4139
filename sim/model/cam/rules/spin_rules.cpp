#include <bit>

#include "sim/model/cam/rules/rule.hpp"

// Ising's spins, which flip by turns like the fields of a checkerboard: spin 0 and its copies 2 to
// 5 for the sides, layer 1 says whose turn it is.
namespace thimble::sim::cam {
namespace {

constexpr std::uint32_t kSpin = 0x3d;
constexpr std::uint32_t kTurn = 0x02;
constexpr std::uint32_t kDemon = 0xc0;

const std::vector<PlaneKick> kToFour{
    {0x04, {0, -1, 0}}, {0x08, {0, 1, 0}}, {0x10, {1, 0, 0}}, {0x20, {-1, 0, 0}}};

std::uint32_t after(std::uint32_t site, bool flips, std::uint32_t demon) {
  const std::uint32_t spin = (site & 1) ^ (flips ? 1U : 0U);
  return (site & ~(kSpin | kTurn | kDemon)) | spin * kSpin | (~site & kTurn) | demon << 6;
}

// Where two of four are up a flip costs nothing.
std::uint32_t q2r(std::uint32_t site) {
  const bool flips = (site & kTurn) != 0 && std::popcount(site & 0x3cU) == 2;
  return after(site, flips, site >> 6 & 3);
}

// Creutz's: a demon of 0 to 3 portions at each site, each as much as two unequal pairs of spins.
std::uint32_t ising_demon(std::uint32_t site) {
  const int demon = static_cast<int>(site >> 6 & 3);
  const int up = std::popcount(site & 0x3cU);
  const int alike = (site & 1) != 0 ? up : 4 - up;
  const int left = demon - (alike - 2);
  const bool flips = (site & kTurn) != 0 && left >= 0 && left <= 3;
  return after(site, flips, static_cast<std::uint32_t>(flips ? left : demon));
}

}  // namespace

void add_spin_rules(std::vector<Rule>& to) {
  to.push_back({.name = "q2r",
                .about = "Vichniac's reversible Ising spins",
                .function = q2r,
                .cycle = {kToFour},
                .matter = kSpin,
                .is_one_cell = true,
                .fill_fraction = 0.25,
                .checker = kTurn});
  std::vector<PlaneKick> with_demons = kToFour;
  with_demons.push_back({kDemon, {1, 2, 0}});
  to.push_back({.name = "ising-demon",
                .about = "Creutz's Ising spins with demons that carry energy",
                .function = ising_demon,
                .cycle = {with_demons},
                .matter = kSpin,
                .is_one_cell = true,
                .fill_fraction = 0.25,
                .noise = kDemon,
                .checker = kTurn});
}

}  // namespace thimble::sim::cam
