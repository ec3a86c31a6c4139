#include "tests/campaign/worlds.hpp"

#include <algorithm>
#include <cstdlib>

#include "tests/campaign/dice.hpp"

namespace thimble::campaign {
namespace {

constexpr int kLabels = 3;
// A file of more would take longer to read than its episode adds.
constexpr int kMostCells = 24;

}  // namespace

std::vector<Material> materials_of(const Setup& setup) {
  std::vector<Material> all;
  if (setup.world != "volume") return all;
  Dice dice(derive(setup.world_seed, 1));
  for (int i = 0; i < setup.materials; ++i) {
    Material material;
    material.stiffness_newton_per_m = dice.chance(0.2) ? 3000 : dice.uniform(50, 800);
    material.damping_newton_s_per_m = dice.uniform(0, 15);
    material.friction = dice.chance(0.5) ? dice.uniform(0, 1) : 0;
    all.push_back(material);
  }
  return all;
}

std::string volume_of(const Setup& setup) {
  const int cells = std::clamp(setup.cells, 3, kMostCells);
  const std::string edge = std::to_string(cells);
  std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: " + edge + ' ' + edge + ' ' +
                     edge + "\nencoding: text\n\n";
  Dice dice(derive(setup.world_seed, 2));
  for (int i = 0; i < cells * cells * cells; ++i) {
    const int x = i % cells;
    const int y = i / cells % cells;
    const int z = i / cells / cells;
    const int outermost = std::max(
        {std::abs(2 * x - cells + 1), std::abs(2 * y - cells + 1), std::abs(2 * z - cells + 1)});
    const bool is_shell = outermost == cells - 1;
    const bool is_middle = outermost <= 2 && !is_shell;
    const bool is_filled = is_shell || (dice.chance(0.25) && !is_middle);
    text += std::to_string(is_filled ? 1 + dice.below(kLabels) : 0) + '\n';
  }
  return text;
}

std::string more_configuration(const Setup& setup) {
  std::string text;
  int label = 0;
  for (const Material& material : materials_of(setup)) {
    const std::string number = std::to_string(++label);
    text += "\n[[world.material]]\nname = \"number " + number + "\"\nfrom = " + number +
            "\nstiffness_newton_per_m = " + std::to_string(material.stiffness_newton_per_m) +
            "\ndamping_newton_s_per_m = " + std::to_string(material.damping_newton_s_per_m) +
            "\nfriction = " + std::to_string(material.friction) + '\n';
  }
  if (!setup.has_bystander) return text;
  return text +
         "\n[[arm]]\nname = \"left\"\ndevice = \"sim:phantom-vintage\"\namplifier_max_a = 3.0\n"
         "world = \"box\"\n[arm.hand]\nmotion = \"explore\"\nseed = " +
         std::to_string(setup.hand_seed + 7) + '\n';
}

}  // namespace thimble::campaign
