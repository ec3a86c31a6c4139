#include "daemon/session/world_settings.hpp"

#include <cstddef>
#include <cstdint>

#include "daemon/session/live_settings.hpp"
#include "daemon/session/piece_settings.hpp"
#include "daemon/world/block_world.hpp"
#include "daemon/world/fields/field_world.hpp"
#include "daemon/world/io/world_source.hpp"
#include "daemon/world/shapes/shape_world.hpp"
#include "daemon/world/sphere_world.hpp"

namespace thimble::session {
namespace {

Result<std::unique_ptr<world::World>> make_sphere(const config::SphereConfig& said) {
  const auto& [x_m, y_m, z_m] = said.center_m;
  Result<world::SphereWorld> sphere = world::SphereWorld::create(
      {{x_m, y_m, z_m}, said.radius_m, said.floor_m}, {{said.stiffness_newton_per_m.value_or(-1)},
                                                       {said.damping_newton_s_per_m.value_or(-1)},
                                                       said.friction.value_or(-1),
                                                       said.temperature_kelvin.value_or(-1)});
  if (!sphere) return tl::unexpected(sphere.error());
  return std::make_unique<world::SphereWorld>(*std::move(sphere));
}

Result<std::unique_ptr<world::World>> make_field(const config::WorldConfig& said) {
  auto field = said.field->is_mesh ? world::load_mesh_field(said.source, mesh_options(said))
                                   : world::load_field_file(said.source, field_options(said));
  if (!field) return tl::unexpected(field.error());
  return std::make_unique<world::FieldWorld>(
      *std::move(field), said.source,
      world::Material{{said.field->stiffness_newton_per_m.value_or(-1)},
                      {said.field->damping_newton_s_per_m.value_or(-1)},
                      said.field->friction.value_or(-1),
                      said.field->temperature_kelvin.value_or(-1)});
}

[[nodiscard]] world::ShapeKind kind_of(config::ShapeKind said) noexcept {
  switch (said) {
    case config::ShapeKind::Box:
      return world::ShapeKind::Box;
    case config::ShapeKind::Capsule:
      return world::ShapeKind::Capsule;
    case config::ShapeKind::Cylinder:
      return world::ShapeKind::Cylinder;
    case config::ShapeKind::Floor:
      return world::ShapeKind::Floor;
    case config::ShapeKind::Sphere:
      break;
  }
  return world::ShapeKind::Sphere;
}

Result<std::unique_ptr<world::World>> make_shapes(const std::vector<config::ShapeConfig>& all) {
  std::vector<world::Shape> shapes;
  for (const config::ShapeConfig& said : all) {
    const bool is_box = said.kind == config::ShapeKind::Box;
    world::Shape shape{.kind = kind_of(said.kind), .radius_m = said.radius_m};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      shape.center[axis] = said.center_m[axis];
      shape.turn_rad[axis] = said.rotation_rad[axis];
      shape.half_m[axis] = (is_box ? said.size_m[axis] : said.length_m) / 2;
    }
    shape.surface = {{said.stiffness_newton_per_m.value_or(-1)},
                     {said.damping_newton_s_per_m.value_or(-1)},
                     said.friction.value_or(-1),
                     said.temperature_kelvin.value_or(-1)};
    shapes.push_back(shape);
  }
  Result<world::ShapeWorld> made = world::ShapeWorld::create(shapes);
  if (!made) return tl::unexpected(made.error());
  return std::make_unique<world::ShapeWorld>(*std::move(made));
}

Result<std::unique_ptr<world::World>> make_block(const config::BlockConfig& said) {
  const auto& [x_newton, y_newton, z_newton] = said.weight_newton;
  Result<world::BlockWorld> block =
      world::BlockWorld::create({.room_m = said.room_m,
                                 .edge_m = said.edge_m,
                                 .drag_newton_s_per_m = said.drag_newton_s_per_m,
                                 .friction = said.friction,
                                 .weight = {x_newton, y_newton, z_newton}});
  if (!block) return tl::unexpected(block.error());
  return std::make_unique<world::BlockWorld>(*std::move(block));
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
                                  material.friction.value_or(-1),
                                  material.temperature_kelvin.value_or(-1)}});
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

world::FieldOptions field_options(const config::WorldConfig& said) {
  const config::FieldConfig field = said.field.value_or(config::FieldConfig{});
  const auto& [x_m, y_m, z_m] = field.center_m;
  return {volume_options(said), field.unit_m.value_or(1), {x_m, y_m, z_m}};
}

world::MeshFieldOptions mesh_options(const config::WorldConfig& said) {
  const config::FieldConfig field = said.field.value_or(config::FieldConfig{});
  const auto& [x_m, y_m, z_m] = field.center_m;
  world::MeshFieldOptions out{.resolution = static_cast<std::uint32_t>(field.resolution),
                              .unit_m = field.unit_m,
                              .center = {x_m, y_m, z_m}};
  out.longest_m = field.longest_m.value_or(out.longest_m);
  return out;
}

bool is_board_plugged_in(const config::WorldConfig& said) noexcept {
  using enum config::PieceBoardKind;
  return said.pieces && (said.pieces->board == Usb || said.pieces->board == Pci);
}

Result<MadeWorld> make_world(const config::WorldConfig& said, const Clock* clock,
                             const BoardPlugs& plugs) {
  if (said.pieces) return make_piece_world(said, clock, plugs);
  auto world = said.automaton         ? make_live_world(said)
               : said.sphere          ? make_sphere(*said.sphere)
               : said.block           ? make_block(*said.block)
               : !said.shapes.empty() ? make_shapes(said.shapes)
               : said.field           ? make_field(said)
                                      : world::make_world(said.source, volume_options(said));
  if (!world) return tl::unexpected(world.error());
  return MadeWorld{*std::move(world), nullptr};
}

}  // namespace thimble::session
