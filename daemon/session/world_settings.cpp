#include "daemon/session/world_settings.hpp"

#include <cstddef>
#include <cstdint>

namespace thimble::session {

world::VolumeOptions volume_options(const config::WorldConfig& said) {
  world::VolumeOptions options{.workspace_m = said.workspace_m,
                               .threshold = said.threshold,
                               .cell_m = said.cell_m,
                               .spacing = said.spacing};
  for (const config::MaterialConfig& material : said.materials) {
    options.materials.push_back({material.from,
                                 material.to,
                                 {{material.stiffness_newton_per_m.value_or(-1)},
                                  {material.damping_newton_s_per_m.value_or(-1)},
                                  material.friction.value_or(-1)}});
  }
  // The configuration has checked that these are x, y and z in some order, each with or without -.
  std::size_t axis = 0;
  for (const char letter : said.axis_order) {
    if (axis >= options.axis_order.size()) break;
    if (letter == '-') {
      options.is_reversed[axis] = true;
    } else {
      options.axis_order[axis++] = static_cast<std::uint8_t>(letter - 'x');
    }
  }
  return options;
}

}  // namespace thimble::session
