#include <bit>

#include "sim/model/cam/rules/rule.hpp"

// Lattice gases: a layer is a direction, and its kick flies on.
namespace thimble::sim::cam {
namespace {

std::uint32_t keep(std::uint32_t site, std::uint32_t but) { return site & ~but; }
std::uint32_t bit(std::uint32_t site, int layer) { return site >> layer & 1; }

// Layers 0 to 3: -y, +y, +x, -x.
const std::vector<PlaneKick> kFour{
    {1, {0, -1, 0}}, {2, {0, 1, 0}}, {4, {1, 0, 0}}, {8, {-1, 0, 0}}};

// A lone head-on pair turns.
std::uint32_t hpp(std::uint32_t site) {
  const std::uint32_t gas = site & 0xf;
  return keep(site, 0xf) | (gas == 0x3 ? 0xcU : gas == 0xc ? 0x3U : gas);
}

// Six directions on a sheared square lattice; layer 6 says which way pairs turn.
const std::vector<PlaneKick> kHexagonal{{1, {1, 0, 0}},   {2, {0, 1, 0}},   {4, {-1, 1, 0}},
                                        {8, {-1, 0, 0}},  {16, {0, -1, 0}}, {32, {1, -1, 0}},
                                        {0x40, {3, 1, 0}}};

std::uint32_t turn_six(std::uint32_t gas) { return (gas << 1 | gas >> 5) & 0x3f; }

std::uint32_t fhp(std::uint32_t site) {
  const std::uint32_t gas = site & 0x3f;
  std::uint32_t after = gas;
  if (gas == 0x09 || gas == 0x12 || gas == 0x24) {
    after = bit(site, 6) != 0 ? turn_six(gas) : turn_six(turn_six(gas));
  }
  if (gas == 0x15 || gas == 0x2a) after = gas ^ 0x3f;
  return keep(site, 0x3f) | after;
}

const std::vector<PlaneKick> kSix{{1, {1, 0, 0}},  {2, {-1, 0, 0}}, {4, {0, 1, 0}},
                                  {8, {0, -1, 0}}, {16, {0, 0, 1}}, {32, {0, 0, -1}}};

// A lone head-on pair goes on along the next axis.
std::uint32_t gas_3d(std::uint32_t site) {
  const std::uint32_t gas = site & 0x3f;
  const std::uint32_t after = gas == 0x03 ? 0x0cU : gas == 0x0c ? 0x30U : gas == 0x30 ? 0x03U : gas;
  return keep(site, 0x3f) | after;
}

// Gas as above in 0 to 3; crystal 4 and its copies 5 to 8 for the sides; random bits 9 with 11, and
// 10 with 12.
constexpr std::uint32_t kCrystal = 0x1f0;
const std::vector<PlaneKick> kAggregate{
    {1, {0, -1, 0}},    {2, {0, 1, 0}},      {4, {1, 0, 0}},      {8, {-1, 0, 0}},
    {0x20, {0, -1, 0}}, {0x40, {0, 1, 0}},   {0x80, {1, 0, 0}},   {0x100, {-1, 0, 0}},
    {0x200, {3, 1, 0}}, {0x400, {-1, 5, 0}}, {0x800, {2, -7, 0}}, {0x1000, {-5, -3, 0}}};

std::uint32_t turned(std::uint32_t gas, std::uint32_t quarters) {
  constexpr std::array<int, 4> kRound{0, 2, 1, 3};  // -y, +x, +y, -x: a quarter each
  std::uint32_t after = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    after |= bit(gas, kRound[i]) << kRound[(i + quarters) % 4];
  }
  return after;
}

// Gas goes a random way; beside the crystal one particle of a site becomes crystal.
std::uint32_t aggregate(std::uint32_t site) {
  std::uint32_t gas = site & 0xf;
  bool is_crystal = bit(site, 4) != 0;
  if (!is_crystal && (site & 0x1e0) != 0 && gas != 0) {
    is_crystal = true;
    gas &= gas - 1;
  }
  const std::uint32_t quarters = (bit(site, 9) ^ bit(site, 11)) | (bit(site, 10) ^ bit(site, 12))
                                                                      << 1;
  return keep(site, 0xf | kCrystal) | turned(gas, quarters) | (is_crystal ? kCrystal : 0);
}

// Gas as `kSix` has it in 0 to 5; crystal 6 and its copies 7 to 12 for the sides; random bits 13
// and 14, which the gas stirs: by themselves they would come round with the torus.
constexpr std::uint32_t kCrystalInSpace = 0x1fc0;
const std::vector<PlaneKick> kAggregateInSpace{
    {0x01, {1, 0, 0}},    {0x02, {-1, 0, 0}},  {0x04, {0, 1, 0}},  {0x08, {0, -1, 0}},
    {0x10, {0, 0, 1}},    {0x20, {0, 0, -1}},  {0x80, {1, 0, 0}},  {0x100, {-1, 0, 0}},
    {0x200, {0, 1, 0}},   {0x400, {0, -1, 0}}, {0x800, {0, 0, 1}}, {0x1000, {0, 0, -1}},
    {0x2000, {3, 1, -1}}, {0x4000, {-1, 5, 2}}};

// Gas goes a random way, never straight back; beside the crystal one particle of a site becomes
// crystal.
std::uint32_t aggregate_in_space(std::uint32_t site) {
  std::uint32_t gas = site & 0x3f;
  bool is_crystal = bit(site, 6) != 0;
  if (!is_crystal && (site & 0x1f80) != 0 && gas != 0) {
    is_crystal = true;
    gas &= gas - 1;
  }
  constexpr std::array<int, 4> kTurns{0, 2, 3, 4};
  const int turn = kTurns[site >> 13 & 3];
  const std::uint32_t turned = (gas << turn | gas >> (6 - turn)) & 0x3f;
  const std::uint32_t stirred = (site & 0x6000) ^ bit(site, 0) << 13 ^ bit(site, 3) << 14;
  return (site & 0x8000) | stirred | turned | (is_crystal ? kCrystalInSpace : 0);
}

}  // namespace

void add_gas_rules(std::vector<Rule>& to) {
  to.push_back({.name = "hpp",
                .about = "lattice gas of Hardy, Pomeau and de Pazzis",
                .function = hpp,
                .cycle = {kFour},
                .matter = 0xf,
                .fill_fraction = 0.25});
  to.push_back({.name = "fhp",
                .about = "lattice gas of Frisch, Hasslacher and Pomeau, on a sheared lattice",
                .function = fhp,
                .cycle = {kHexagonal},
                .matter = 0x3f,
                .fill_fraction = 0.25,
                .noise = 0x40});
  to.push_back({.name = "gas-3d",
                .about = "gas of six directions in three dimensions",
                .function = gas_3d,
                .cycle = {kSix},
                .matter = 0x3f,
                .fill_fraction = 0.25});
  to.push_back({.name = "dla",
                .about = "a crystal that grows by what diffuses to it",
                .function = aggregate,
                .cycle = {kAggregate},
                .matter = 0xf,
                .fill_fraction = 0.05,
                .noise = 0x1e00,
                .crystal = kCrystal});
  to.push_back({.name = "dla-3d",
                .about = "the same in three dimensions",
                .function = aggregate_in_space,
                .cycle = {kAggregateInSpace},
                .matter = 0x3f,
                .fill_fraction = 0.02,
                .noise = 0x6000,
                .crystal = kCrystalInSpace});
}

}  // namespace thimble::sim::cam
