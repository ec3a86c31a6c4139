#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "daemon/coupling/wave_arm.hpp"
#include "daemon/coupling/wave_world.hpp"
#include "fake_box.hpp"
#include "linked_loop.hpp"

namespace thimble::coupling::testing {

// The energy of one way, reckoned from the distances alone: sums of joule could be wrong together.
class ReckonedEnergy {
 public:
  void begin(const WaveDistance3& distance) { last_ = distance; }
  // `distance` is that of the sums `dt_s` later.
  void add(const WaveDistance3& distance, double dt_s) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double wave = (distance[axis] - last_[axis]) / dt_s;
      joule_[axis] += wave * wave * dt_s / 2;
    }
    last_ = distance;
  }
  [[nodiscard]] double joule(std::size_t axis) const { return joule_[axis]; }

 private:
  WaveDistance3 last_{};
  std::array<double, 3> joule_{};
};

// A far end that is asked for each of the slave's steps by itself, in which no wave changes.
class WatchedWorld final : public WorldCoupling {
 public:
  explicit WatchedWorld(WaveWorld& world) : world_(world) {}

  Result<void> open(const HandSample& first) override {
    const Result<void> opened = world_.open(first);
    came_out.begin(world_.incoming().taken().distance);
    went_in.begin(world_.sent().distance);
    last_ = first;
    return opened;
  }
  ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override {
    for (; dt > Slave::kStep; dt -= Slave::kStep) (void)step(last_, Slave::kStep);
    last_ = sample;
    return step(sample, dt);
  }
  void close() noexcept override { world_.close(); }

  // F·v·dt that left by the slave's port: what the slave carries and the walls took, J.
  [[nodiscard]] double slave_joule() const {
    const double speed = norm(world_.slave().velocity());
    return walls_joule_ + SlaveSettings{}.mass_kg * speed * speed / 2;
  }

  ReckonedEnergy came_out;  // of the way from the arm
  ReckonedEnergy went_in;   // to the way back

 private:
  ConstraintSet step(const HandSample& sample, Duration dt) noexcept {
    const Position3 at = world_.slave().at();
    const Force3 wall = world_.slave().wall_force();
    ConstraintSet reply = world_.answer(sample, dt);
    walls_joule_ -= dot(wall, world_.slave().at() - at);
    if (dt <= Duration::zero()) return reply;
    came_out.add(world_.incoming().taken().distance, seconds(dt));
    went_in.add(world_.sent().distance, seconds(dt));
    return reply;
  }

  WaveWorld& world_;
  HandSample last_{};
  double walls_joule_{0};
};

// Both halves of it on a link, and what passes through each port.
struct WatchedWaves {
  WatchedWaves(const WaveSettings& settings, const link::ImpairmentSettings& impairment,
               double half_m, Duration servo)
      : arm(settings), box(half_m), loop(arm, far_end, servo, impairment) {}

  void move(Position3 to) {
    const double dt_s = seconds(loop.dt());
    const Displacement3 way = to - at;
    const ArmOutput out = loop.tick(at, Velocity3{way.x / dt_s, way.y / dt_s, way.z / dt_s});
    at = to;
    hand_joule -= dot(out.force, way);
    hardest_newton = std::max(hardest_newton, norm(out.force));
    went_in.add(out.sample.waves.distance, dt_s);
    came_out.add(arm.incoming().taken().distance, dt_s);
  }

  WaveArm arm;
  FakeBox box;
  WaveWorld world{box, 1, {}};
  WatchedWorld far_end{world};
  LinkedLoop loop;
  Position3 at{};
  double hand_joule{0};  // F·v·dt that the hand put in
  double hardest_newton{0};
  ReckonedEnergy went_in;   // to the way to the world
  ReckonedEnergy came_out;  // of the way back
};

}  // namespace thimble::coupling::testing
