#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>

#include "daemon/coupling/constraint_model.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/world/voxel_world.hpp"
#include "hand_on_arm.hpp"

namespace thimble::coupling::testing {

// Thesis 3.6: the constraint is known one cell ahead, and where the world has it. The hand is told
// of every occupied cell beside the last free one it was in.
class BufferZoneWorld final : public WorldCoupling {
 public:
  explicit BufferZoneWorld(const world::VoxelGrid& grid) : grid_(grid) {}

  Result<void> open(const HandSample& first) override {
    follow(first.hand);
    return {};
  }
  ConstraintSet answer(const HandSample& sample, Duration /*dt*/) noexcept override {
    follow(sample.hand);
    ConstraintSet set;
    set.sequence = ++replies_;
    set.session = 1;
    world::Cell ahead = cell_;
    ++ahead.x;
    if (grid_.is_occupied(ahead)) {
      set.planes.push_back({.normal = {1, 0, 0}, .offset_m = grid_.face_m(0, ahead.x)});
    }
    return set;
  }
  void close() noexcept override {}

 private:
  // As far towards the hand as cells are free.
  void follow(Position3 hand) {
    const std::int32_t wanted = grid_.lower_index(0, hand.x);
    const std::int32_t step = wanted > cell_.x ? 1 : -1;
    for (world::Cell next = cell_; cell_.x != wanted; cell_ = next) {
      next.x += step;
      if (grid_.is_occupied(next)) return;
    }
  }
  const world::VoxelGrid& grid_;
  world::Cell cell_{};
  std::uint64_t replies_{0};
};

inline constexpr Stiffness kHardWall{800};

enum class Told { ByGhostPoint, BySimpleModel, ByBufferZone };

// A row of cells along x, filled from 10 mm on. The edge gives way by one cell, once a sample at
// most, when the hand presses it with kBreak_newton or more: a part that rubs on its ground.
class PushedEdge final : public WorldCoupling {
 public:
  static constexpr double kBreak_newton = 1;

  PushedEdge(double cell_m, Told told, Stiffness wall)
      : wall_(wall), world_(row(cell_m), "row"), front_(first_filled(*world_.grid())) {
    if (told == Told::ByBufferZone) {
      inner_ = std::make_unique<BufferZoneWorld>(*world_.grid());
    } else {
      inner_ = make_world_coupling(told == Told::BySimpleModel ? ConstraintModel::Simple
                                                               : ConstraintModel::GhostPoint,
                                   world_, 1)
                   .value();
    }
  }
  Result<void> open(const HandSample& first) override { return inner_->open(first); }
  ConstraintSet answer(const HandSample& sample, Duration dt) noexcept override {
    const double depth_m = sample.hand.x - edge_m();
    if (wall_.newton_per_m * depth_m >= kBreak_newton) {
      world_.set_cell({front_, 0, 0}, false);
      ++front_;
      ++steps_;
    }
    return inner_->answer(sample, dt);
  }
  void close() noexcept override { inner_->close(); }

  [[nodiscard]] double edge_m() const { return world_.grid()->face_m(0, front_); }
  [[nodiscard]] int steps() const { return steps_; }

 private:
  static world::VoxelGrid row(double cell_m) {
    const auto cells = static_cast<std::uint32_t>(0.090 / cell_m + 0.5);
    world::VoxelGrid grid = world::VoxelGrid::create({cells, 1, 1}, cell_m).value();
    for (auto x = first_place(grid); x < static_cast<std::int32_t>(cells); ++x) {
      grid.set_occupied({x, 0, 0}, true);
    }
    return grid;
  }
  static std::int32_t first_place(const world::VoxelGrid& grid) {
    return grid.lower_index(0, 0.010) + 1;
  }
  static std::int32_t first_filled(const world::VoxelGrid& grid) {
    world::Cell cell;
    while (!grid.is_occupied(cell)) ++cell.x;
    return cell.x;
  }

  Stiffness wall_;
  world::VoxelWorld world_;
  std::int32_t front_;
  int steps_{0};
  std::unique_ptr<WorldCoupling> inner_;
};

// The falls of a force that goes up and down, each from a crest to the trough behind it; less than
// kTooth_newton is none.
class Teeth {
 public:
  static constexpr double kTooth_newton = 0.25;
  static constexpr double kNothing_newton = 0.01;

  void add(double newton) {
    if (is_falling_) {
      low_newton_ = std::min(low_newton_, newton);
      if (newton < low_newton_ + kTooth_newton) return;
      end_fall();
    }
    high_newton_ = std::max(high_newton_, newton);
    largest_newton_ = std::max(largest_newton_, newton);
    if (newton > high_newton_ - kTooth_newton) return;
    is_falling_ = true;
    low_newton_ = newton;
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int to_nothing() const { return to_nothing_; }
  [[nodiscard]] double mean_newton() const { return count_ > 0 ? sum_newton_ / count_ : 0; }
  [[nodiscard]] double largest_newton() const { return largest_newton_; }

 private:
  void end_fall() {
    ++count_;
    sum_newton_ += high_newton_ - low_newton_;
    to_nothing_ += low_newton_ <= kNothing_newton ? 1 : 0;
    is_falling_ = false;
    high_newton_ = low_newton_;
  }
  bool is_falling_{false};
  double high_newton_{0};
  double low_newton_{0};
  double largest_newton_{0};
  double sum_newton_{0};
  int count_{0};
  int to_nothing_{0};
};

// What a finger feels that pushes an edge 25 mm along, drawn at kPush_m_per_s by a hand of 200 N/m,
// from the first step of the edge on.
struct Ratchet {
  Teeth teeth;
  int cells{0};  // that gave way
  double edge_travel_m{0};
  double hand_travel_m{0};
  double offset_m{0};  // at the end
};

inline Ratchet push_edge(double cell_m, Told told, Duration delay, Stiffness wall = kHardWall) {
  constexpr double kPush_m_per_s = 0.05;
  constexpr double kReach_m = 0.060;
  constexpr double kEdgeEnd_m = 0.035;
  GhostPointArm arm{GhostPointSettings{.stiffness = wall, .cell_m = cell_m}};
  auto world = std::make_unique<PushedEdge>(cell_m, told, wall);
  const PushedEdge& edge = *world;
  HandOnArm hand(arm, std::move(world), delay);
  Ratchet out;
  double first_edge_m = 0;
  double first_hand_m = 0;
  for (double drawn_m = 0; drawn_m < kReach_m && edge.edge_m() < kEdgeEnd_m;
       drawn_m += kPush_m_per_s * 1e-3) {
    const ArmOutput output = hand.tick(drawn_m, kPush_m_per_s);
    if (edge.steps() == 0) {
      first_edge_m = edge.edge_m();
      first_hand_m = hand.x_m();
      continue;
    }
    out.teeth.add(-output.force.x);
    out.cells = edge.steps();
    out.edge_travel_m = edge.edge_m() - first_edge_m;
    out.hand_travel_m = hand.x_m() - first_hand_m;
    out.offset_m = output.offset.x;
  }
  return out;
}

}  // namespace thimble::coupling::testing
