#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/world/sphere_world.hpp"
#include "daemon/world/world.hpp"
#include "tests/unit/world/symmetry.hpp"

namespace thimble::coupling::testing {

// Round a ball and over its floor: tangent planes of any angle, and edges between them.
inline Position3 about(double t_s) {
  return {0.021 * std::sin(1.1 * t_s), -0.012 + 0.028 * std::sin(1.7 * t_s + 1),
          0.023 * std::sin(0.9 * t_s + 2)};
}
inline Velocity3 about_speed(double t_s) {
  return {0.021 * 1.1 * std::cos(1.1 * t_s), 0.028 * 1.7 * std::cos(1.7 * t_s + 1),
          0.023 * 0.9 * std::cos(0.9 * t_s + 2)};
}

inline world::SphereWorld make_ball() {
  return world::SphereWorld::create({{0, -0.025, 0}, 0.02, -0.035}).value();
}

// A world as another that was turned: hands go in turned back, what it says comes out turned.
class TurnedWorld final : public world::World {
 public:
  TurnedWorld(world::World& of, const world::Symmetry& turn) : of_(of), turn_(turn) {}
  [[nodiscard]] const world::WorldInfo& info() const noexcept override { return of_.info(); }
  [[nodiscard]] Result<world::ProbeId> add_probe(Position3 hand) override {
    return of_.add_probe(original(turn_, hand));
  }
  void remove_probe(world::ProbeId probe) noexcept override { of_.remove_probe(probe); }
  world::ProbeMotion move_probe(world::ProbeId probe, Position3 hand,
                                Duration dt) noexcept override {
    world::ProbeMotion motion = of_.move_probe(probe, original(turn_, hand), dt);
    motion.ghost = image(turn_, motion.ghost);
    motion.pressure = image(turn_, motion.pressure);
    for (world::ContactPlane& plane : motion.planes) plane.normal = image(turn_, plane.normal);
    return motion;
  }

 private:
  world::World& of_;
  world::Symmetry turn_;
};

// What a hand that was turned feels in a tick, turned back.
struct FeltTurnedBack {
  FeltTurnedBack(const world::Symmetry& turn, const ArmOutput& out)
      : force(original(turn, out.force)), offset(original(turn, out.offset)) {}
  Force3 force;
  Displacement3 offset;
};
using TurnedTrace = std::vector<FeltTurnedBack>;
using FeelTurned = std::function<TurnedTrace(world::World&, const world::Symmetry&)>;
using FeelTurnedCells = std::function<TurnedTrace(const world::VoxelGrid&, const world::Symmetry&)>;

// All 48 turns. Signs change no rounding; permuted axes do where sums of three products are rounded
// in their order, which `permuted_newton` leaves room for, and of offsets a millimetre each newton.
inline void expect_every_turn_alike(const std::function<TurnedTrace(const world::Symmetry&)>& feel,
                                    double permuted_newton) {
  const TurnedTrace reference = feel({});
  for (const world::Symmetry& turn : world::all_symmetries()) {
    const TurnedTrace felt = feel(turn);
    const double room_newton = turn.exchanges_axes() ? permuted_newton : 0;
    SCOPED_TRACE(::testing::PrintToString(turn.to) + ::testing::PrintToString(turn.is_mirrored));
    ASSERT_EQ(felt.size(), reference.size());
    for (std::size_t i = 0; i < reference.size(); ++i) {
      ASSERT_LE(norm(felt[i].force - reference[i].force), room_newton) << i;
      ASSERT_LE(norm(felt[i].offset - reference[i].offset), 1e-3 * room_newton) << i;
    }
  }
}
inline void expect_turned_is_felt_turned(world::World& world, const FeelTurned& feel,
                                         double permuted_newton) {
  const auto turned = [&](const world::Symmetry& turn) {
    TurnedWorld there(world, turn);
    return feel(there, turn);
  };
  expect_every_turn_alike(turned, permuted_newton);
}
inline void expect_turned_cells_are_felt_turned(const world::VoxelGrid& grid,
                                                const FeelTurnedCells& feel,
                                                double permuted_newton) {
  const auto turned = [&](const world::Symmetry& turn) { return feel(image(turn, grid), turn); };
  expect_every_turn_alike(turned, permuted_newton);
}

// How often a force is felt that a person would notice.
inline int ticks_felt(const TurnedTrace& trace) {
  return static_cast<int>(std::count_if(trace.begin(), trace.end(),
                                        [](const auto& felt) { return norm(felt.force) > 0.1; }));
}

}  // namespace thimble::coupling::testing
