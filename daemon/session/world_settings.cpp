#include "daemon/session/world_settings.hpp"

#include <algorithm>

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
  // The configuration has checked that these are x, y and z in some order.
  for (std::size_t i = 0; i < std::min<std::size_t>(3, said.axis_order.size()); ++i) {
    options.axis_order[i] = static_cast<std::uint8_t>(said.axis_order[i] - 'x');
  }
  return options;
}

}  // namespace thimble::session
