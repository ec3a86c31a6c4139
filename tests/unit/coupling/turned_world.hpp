#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "daemon/world/sphere_world.hpp"
#include "daemon/world/world.hpp"

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

// The same hand by the axes `shift` further, mirrored along those of `mirror`.
struct Turn {
  std::size_t shift{0};
  std::array<double, 3> mirror{1, 1, 1};

  template <class Quantity>
  [[nodiscard]] Quantity there(const Quantity& v) const {
    Quantity out;
    for (std::size_t axis = 0; axis < 3; ++axis) out[(axis + shift) % 3] = mirror[axis] * v[axis];
    return out;
  }
  template <class Quantity>
  [[nodiscard]] Quantity back(const Quantity& v) const {
    Quantity out;
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = mirror[axis] * v[(axis + shift) % 3];
    return out;
  }
};

// A world as another that was turned: hands go in turned back, what it says comes out turned.
class TurnedWorld final : public world::World {
 public:
  TurnedWorld(world::World& of, const Turn& turn) : of_(of), turn_(turn) {}
  [[nodiscard]] const world::WorldInfo& info() const noexcept override { return of_.info(); }
  [[nodiscard]] Result<world::ProbeId> add_probe(Position3 hand) override {
    return of_.add_probe(turn_.back(hand));
  }
  void remove_probe(world::ProbeId probe) noexcept override { of_.remove_probe(probe); }
  world::ProbeMotion move_probe(world::ProbeId probe, Position3 hand,
                                Duration dt) noexcept override {
    world::ProbeMotion motion = of_.move_probe(probe, turn_.back(hand), dt);
    motion.ghost = turn_.there(motion.ghost);
    for (world::ContactPlane& plane : motion.planes) plane.normal = turn_.there(plane.normal);
    return motion;
  }

 private:
  world::World& of_;
  Turn turn_;
};

// The forces in a world with a hand that was turned, turned back.
using FeelTurned = std::function<std::vector<Force3>(world::World&, const Turn&)>;

// Signs change no rounding; permuted axes do where sums of three products are rounded in their
// order, which `permuted_newton` leaves room for.
inline void expect_turned_is_felt_turned(world::World& world, const FeelTurned& feel,
                                         double permuted_newton) {
  const auto turned = [&](const Turn& turn) {
    TurnedWorld there(world, turn);
    return feel(there, turn);
  };
  const std::vector<Force3> reference = turned({});
  for (const auto& mirror : {std::array<double, 3>{-1, 1, 1}, {1, -1, -1}, {-1, -1, -1}}) {
    EXPECT_EQ(turned({.shift = 0, .mirror = mirror}), reference);
    for (const std::size_t shift : {1U, 2U}) {
      const std::vector<Force3> permuted = turned({.shift = shift, .mirror = mirror});
      ASSERT_EQ(permuted.size(), reference.size());
      for (std::size_t i = 0; i < reference.size(); ++i) {
        ASSERT_LE(norm(permuted[i] - reference[i]), permuted_newton) << shift << ", " << i;
      }
    }
  }
}

}  // namespace thimble::coupling::testing
