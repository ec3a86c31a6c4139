#pragma once

#include <functional>
#include <string>
#include <vector>

#include "daemon/world/plane_projection.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"
#include "lab/constraint_models/scenes.hpp"

namespace thimble::lab {

// What a model makes of one place of the hand.
struct HeldHand {
  Position3 hand{};
  Position3 ghost{};  // the hand, of the simple model
  Position3 proxy{};  // the god-object: nearest to the hand of what its planes leave free
  world::PastPlanes planes{};
  world::PlaneProjection projection{};
};

// A constraint model in a scene, one place after the other.
struct Model {
  std::string name;
  bool has_ghost{true};
  double matter_m{0};  // how deep in the scene's matter its ghost may be, by how it is made
  std::function<world::ProbeMotion(Position3 hand)> move{};
};

// Those that can play in `scene`: the simple model and the ghost point of cells where it has cells,
// the god-object in shapes, and in their signed distance field of 1 mm steps. Each owns its world.
// Errors: a world's, which a scene of ours has not.
[[nodiscard]] Result<std::vector<Model>> make_models(const Scene& scene);

// Moves the model's probe to `hand`, m, in the scene's frame, and says what holds it there: its
// planes, and the nearest place that they leave free (plane_projection.hpp). Each call is a tick
// after the one before, so that the order of places matters. Errors: none.
[[nodiscard]] HeldHand hold(const Model& model, Position3 hand);

}  // namespace thimble::lab
