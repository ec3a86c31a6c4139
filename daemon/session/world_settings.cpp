#include "daemon/session/world_settings.hpp"

#include <cstddef>
#include <cstdint>

#include "daemon/session/live_settings.hpp"
#include "daemon/session/piece_settings.hpp"
#include "daemon/world/io/world_source.hpp"
#include "daemon/world/sphere_world.hpp"

namespace thimble::session {
namespace {

Result<std::unique_ptr<world::World>> make_sphere(const config::SphereConfig& said) {
  const auto& [x_m, y_m, z_m] = said.center_m;
  Result<world::SphereWorld> sphere = world::SphereWorld::create(
      {{x_m, y_m, z_m}, said.radius_m, said.floor_m}, {{said.stiffness_newton_per_m.value_or(-1)},
                                                       {said.damping_newton_s_per_m.value_or(-1)},
                                                       said.friction.value_or(-1)});
  if (!sphere) return tl::unexpected(sphere.error());
  return std::make_unique<world::SphereWorld>(*std::move(sphere));
}

}  // namespace

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

bool is_board_plugged_in(const config::WorldConfig& said) noexcept {
  using enum config::PieceBoardKind;
  return said.pieces && (said.pieces->board == Usb || said.pieces->board == Pci);
}

Result<MadeWorld> make_world(const config::WorldConfig& said, const Clock* clock,
                             const BoardPlugs& plugs) {
  if (said.pieces) return make_piece_world(said, clock, plugs);
  auto world = said.automaton ? make_live_world(said)
               : said.sphere  ? make_sphere(*said.sphere)
                              : world::make_world(said.source, volume_options(said));
  if (!world) return tl::unexpected(world.error());
  return MadeWorld{*std::move(world), nullptr};
}

}  // namespace thimble::session
