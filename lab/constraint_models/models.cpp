#include "lab/constraint_models/models.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <utility>

#include "daemon/world/fields/field_world.hpp"
#include "daemon/world/shapes/shape_world.hpp"
#include "daemon/world/simple_constraints.hpp"
#include "daemon/world/voxel_world.hpp"

namespace thimble::lab {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(1);
constexpr double kFieldStep_m = 0.001;
constexpr double kRounding_m = 1e-9;

Result<Model> of_world(std::string name, double matter_m, std::shared_ptr<world::World> world,
                       Position3 start) {
  const auto probe = world->add_probe(start);
  if (!probe) return tl::unexpected(probe.error());
  return Model{std::move(name), true, matter_m,
               [world = std::move(world), probe = *probe](Position3 hand) {
                 return world->move_probe(probe, hand, kTick);
               }};
}

Model simple_model(const world::VoxelGrid& grid, Position3 start) {
  return {"simple", false, 0,
          [grid, state = world::start_simple_constraints(grid, start)](Position3 hand) mutable {
            return world::constrain_simply(grid, state, hand);
          }};
}

// The distance to the union, at the nodes of a slab about the hand's plane.
Result<world::DistanceField> field_of(const std::vector<world::Shape>& matter) {
  static constexpr std::array<std::uint32_t, 3> kNumbers{101, 101, 9};
  std::vector<world::PlacedShape> shapes;
  shapes.reserve(matter.size());
  for (const world::Shape& shape : matter) shapes.emplace_back(shape);
  std::vector<float> distances_m;
  const auto place_m = [](std::uint32_t i, std::size_t axis) {
    return (i - (kNumbers[axis] - 1) / 2.0) * kFieldStep_m;
  };
  for (std::uint32_t z = 0; z < kNumbers[2]; ++z) {
    for (std::uint32_t y = 0; y < kNumbers[1]; ++y) {
      for (std::uint32_t x = 0; x < kNumbers[0]; ++x) {
        double least_m = 1;
        for (const world::PlacedShape& shape : shapes) {
          const Position3 at{place_m(x, 0), place_m(y, 1), place_m(z, 2)};
          least_m = std::min(least_m, shape.look(at).distance_m);
        }
        distances_m.push_back(static_cast<float>(least_m));
      }
    }
  }
  return world::DistanceField::create(kNumbers, kFieldStep_m, std::move(distances_m));
}

}  // namespace

Result<std::vector<Model>> make_models(const Scene& scene) {
  std::vector<Model> models;
  const auto add = [&](Result<Model> model) -> Result<void> {
    if (!model) return tl::unexpected(model.error());
    models.push_back(*std::move(model));
    return {};
  };
  if (scene.cells) {
    models.push_back(simple_model(*scene.cells, scene.start));
    auto cells = std::make_shared<world::VoxelWorld>(*scene.cells, scene.name);
    if (auto good = add(of_world("cells", kRounding_m, std::move(cells), scene.start)); !good) {
      return tl::unexpected(good.error());
    }
  }
  auto shapes = world::ShapeWorld::create(scene.matter);
  if (!shapes) return tl::unexpected(shapes.error());
  auto field = field_of(scene.matter);
  if (!field) return tl::unexpected(field.error());
  if (auto good =
          add(of_world("shapes", kRounding_m,
                       std::make_shared<world::ShapeWorld>(*std::move(shapes)), scene.start));
      !good) {
    return tl::unexpected(good.error());
  }
  // Between nodes a field may be off by half of a cell's diagonal, in the plane.
  if (auto good = add(of_world("field", 0.71 * kFieldStep_m,
                               std::make_shared<world::FieldWorld>(*std::move(field), scene.name),
                               scene.start));
      !good) {
    return tl::unexpected(good.error());
  }
  return models;
}

HeldHand hold(const Model& model, Position3 hand) {
  const world::ProbeMotion motion = model.move(hand);
  HeldHand held{hand, model.has_ghost ? motion.ghost : hand, hand, {}, {}};
  for (const world::ContactPlane& plane : motion.planes) {
    held.planes.push_back({plane.normal, dot(plane.normal, hand) - plane.offset_m});
  }
  held.projection = world::project(held.planes);
  held.proxy = hand - held.projection.past;
  return held;
}

}  // namespace thimble::lab
