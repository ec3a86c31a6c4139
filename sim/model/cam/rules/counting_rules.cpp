#include <bit>

#include "sim/model/cam/rules/rule.hpp"

// Rules that count a cell's neighbours. The cell and its copies are layers of their own, and each
// copy is kicked to where it is a neighbour.
namespace thimble::sim::cam {
namespace {

std::uint32_t bit(std::uint32_t site, int layer) { return site >> layer & 1; }
std::uint32_t keep(std::uint32_t site, std::uint32_t but) { return site & ~but; }

// Cell 0 and its copies 1 to 8.
constexpr std::uint32_t kNine = 0x1ff;
const std::vector<PlaneKick> kToEight{{0x02, {-1, -1, 0}}, {0x04, {0, -1, 0}}, {0x08, {1, -1, 0}},
                                      {0x10, {-1, 0, 0}},  {0x20, {1, 0, 0}},  {0x40, {-1, 1, 0}},
                                      {0x80, {0, 1, 0}},   {0x100, {1, 1, 0}}};

// B3/S23.
std::uint32_t life(std::uint32_t site) {
  const int neighbors = std::popcount(site & 0x1feU);
  const bool lives = neighbors == 3 || (neighbors == 2 && bit(site, 0) != 0);
  return keep(site, kNine) | (lives ? kNine : 0);
}

// Vichniac's: as the majority of nine says, but for the closest votes; B4678/S35678.
std::uint32_t twisted_majority(std::uint32_t site) {
  const int votes = std::popcount(site & kNine);
  return keep(site, kNine) | (votes == 4 || votes >= 6 ? kNine : 0);
}

// Copies 0 to 5, each for a side.
constexpr std::uint32_t kSix = 0x3f;
const std::vector<PlaneKick> kToSix{{0x01, {1, 0, 0}},  {0x02, {-1, 0, 0}}, {0x04, {0, 1, 0}},
                                    {0x08, {0, -1, 0}}, {0x10, {0, 0, 1}},  {0x20, {0, 0, -1}}};

std::uint32_t parity(std::uint32_t site) {
  return keep(site, kSix) | (std::popcount(site & kSix) % 2 != 0 ? kSix : 0);
}

// Now is 0 and its copies 2 to 5, the past is 1. Toffoli and Margolus's TIME-TUNNEL.
constexpr std::uint32_t kNow = 0x3d;
const std::vector<PlaneKick> kToFour{
    {0x04, {0, -1, 0}}, {0x08, {0, 1, 0}}, {0x10, {1, 0, 0}}, {0x20, {-1, 0, 0}}};

std::uint32_t time_tunnel(std::uint32_t site) {
  const int sum = std::popcount(site & kNow);
  const std::uint32_t next = (sum >= 1 && sum <= 4 ? 1U : 0U) ^ bit(site, 1);
  return keep(site, kNow | 2U) | next * kNow | bit(site, 0) << 1;
}

// Cell 0 and its copies 1 to 6; random bits are 7 with 9, and 8 with 10. Set with the probability
// of 0, 0, 1/4, 1/2, 1/2, 3/4, 1, 1 when so many of seven are (a CAM-8's recipe 30).
constexpr std::uint32_t kSeven = 0x7f;
const std::vector<PlaneKick> kAnneal{{0x02, {1, 0, 0}},   {0x04, {-1, 0, 0}},  {0x08, {0, 1, 0}},
                                     {0x10, {0, -1, 0}},  {0x20, {0, 0, 1}},   {0x40, {0, 0, -1}},
                                     {0x080, {3, 1, 1}},  {0x100, {-1, 5, 1}}, {0x200, {2, -7, 3}},
                                     {0x400, {-5, -3, 1}}};

std::uint32_t anneal(std::uint32_t site) {
  const bool first = (bit(site, 7) ^ bit(site, 9)) != 0;
  const bool second = (bit(site, 8) ^ bit(site, 10)) != 0;
  const std::array<bool, 8> next{false, false, first && second, first, first, first || second,
                                 true,  true};
  return keep(site, kSeven) |
         (next[static_cast<std::size_t>(std::popcount(site & kSeven))] ? kSeven : 0);
}

}  // namespace

void add_counting_rules(std::vector<Rule>& to) {
  to.push_back({.name = "life",
                .about = "Conway's Life, B3/S23",
                .function = life,
                .cycle = {kToEight},
                .matter = kNine,
                .is_one_cell = true});
  to.push_back({.name = "twisted-majority",
                .about = "Vichniac's vote of nine, the closest ones reversed: B4678/S35678",
                .function = twisted_majority,
                .cycle = {kToEight},
                .matter = kNine,
                .is_one_cell = true});
  to.push_back(
      {.name = "parity",
       .about = "a cell becomes the parity of those at its sides, in two or three dimensions",
       .function = parity,
       .cycle = {kToSix},
       .matter = kSix,
       .is_one_cell = true});
  to.push_back(
      {.name = "time-tunnel",
       .about = "second order, reversible: five neighbours neither all nor none, and the past",
       .function = time_tunnel,
       .cycle = {kToFour},
       .matter = kNow,
       .is_one_cell = true});
  to.push_back({.name = "annealing",
                .about = "majority of seven with random bits, in three dimensions",
                .function = anneal,
                .cycle = {kAnneal},
                .matter = kSeven,
                .is_one_cell = true,
                .noise = 0x780});
}

}  // namespace thimble::sim::cam
