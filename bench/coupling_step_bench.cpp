// What one step of the arm half of each coupling scheme costs, pressing on a wall with a fresh
// reply in every step, whose map has as many blocks that are news as one can. Beside it the force
// law of one wall in plain code, as a measure of this machine.
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "bench/comparison.hpp"
#include "bench/reference_tick.hpp"
#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/scheme.hpp"
#include "daemon/coupling/two_port_arm.hpp"
#include "daemon/world/near_cell_finder.hpp"
#include "daemon/world/occupancy_teller.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace {

using namespace thimble;

constexpr int kBatches = 400;
constexpr int kSteps = 50;  // of a batch: so few that hardly any is interrupted
constexpr Duration kServo = std::chrono::milliseconds(1);

// An arm half whose tip trembles 0.2 to 0.5 mm inside a wall, or a corner of three that are not
// square, and a world that answers each step.
class Pressed {
 public:
  Pressed(std::unique_ptr<coupling::ArmCoupling> arm, bool is_corner) : arm_(std::move(arm)) {
    set_.session = 1;
    set_.planes.push_back({.normal = {1, 0, 0}, .offset_m = 0.015});
    if (is_corner) {
      set_.planes.push_back({.normal = {0.6, 0.8, 0}, .offset_m = 0.009});
      set_.planes.push_back({.normal = {0.6, 0, -0.8}, .offset_m = 0.009});
    }
    set_.has_far = true;
    set_.far.force = {-0.3, 0, 0};
    set_.far.slave = {0.015, 0, 0};
    set_.far.is_pressing = true;
    set_.has_ghost = true;
    set_.has_near = true;
    set_.near =
        world::NearCellFinder().find(*world::make_box(3), {.middle = {1, 1, 1}, .reach_m = 0.03});
    const world::VoxelGrid room = room_of_small_cells();
    world::OccupancyTeller teller;
    teller.reset();
    set_.has_map = true;
    set_.map = {.lattice = room.lattice(),
                .ghost_cell = {11, 9, 9},
                .blocks = teller.tell(room, {11, 9, 9}, 1)};
    set_.ghost = {0.015, 0, 0};
    set_.energy_joule = 0;
    arm_->reset(now_, {0.0152, 0, 0});
  }

  void step() {
    now_ = now_ + kServo;
    ++set_.sequence;
    set_.answers = sequence_;
    set_.far.waves.distance.x -= 1e-4;
    set_.far.waves.joule[0] += 1e-5;
    set_.energy_joule += 1e-5;
    for (world::OccupancyBlock& block : set_.map.blocks) ++block.version;  // else they are no news
    const double tip_m = 0.0152 + 0.0001 * static_cast<double>(set_.sequence % 4);
    const coupling::ArmOutput out =
        arm_->step({.now = now_,
                    .dt = kServo,
                    .tip = {tip_m, 0, 0},
                    .tip_velocity = {0.01, 0, 0},
                    .fresh = &set_,
                    .link = {.is_up = true, .round_trip = std::chrono::milliseconds(20)}});
    sequence_ = out.sample.sequence;
    is_in_contact_ = out.is_in_contact;
  }
  [[nodiscard]] bool is_in_contact() const { return is_in_contact_; }
  [[nodiscard]] bool is_map_full() const {
    return set_.map.blocks.size() == world::kMostBlocksTold;
  }

 private:
  // The box with walls at 15 mm, of cells so small that there is more than one block to tell.
  static world::VoxelGrid room_of_small_cells() {
    world::VoxelGrid room = *world::VoxelGrid::create({18, 18, 18}, 0.005);
    room.fill();
    for (world::Cell c{6, 6, 6}; c.z < 12; ++c.z) {
      for (c.y = 6; c.y < 12; ++c.y) {
        for (c.x = 6; c.x < 12; ++c.x) room.set_occupied(c, false);
      }
    }
    return room;
  }

  std::unique_ptr<coupling::ArmCoupling> arm_;
  coupling::ConstraintSet set_{};
  MonotonicTime now_{};
  std::uint64_t sequence_{0};
  bool is_in_contact_{false};
};

// Median of the batches: what a step costs, not what else the machine does meanwhile.
template <class Step>
double nanoseconds_a_step(const Step& step) {
  bench::Slices batches;
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kSteps; ++i) step();
    const auto end = std::chrono::steady_clock::now();
    batches.push_back(std::chrono::duration<double, std::nano>(end - begin).count() / kSteps);
  }
  return bench::median(std::move(batches));
}

bool run(const std::string& name, std::unique_ptr<coupling::ArmCoupling> half, double goal_ns,
         bool is_corner = false) {
  Pressed arm(std::move(half), is_corner);
  ReferenceTick plain;
  bench::Slices ours;
  bench::Slices reference;
  bench::alternate(
      bench::kSlices, [&] { ours.push_back(nanoseconds_a_step([&] { arm.step(); })); },
      [&] { reference.push_back(nanoseconds_a_step([&] { plain.tick(); })); });
  if (!arm.is_in_contact() || !arm.is_map_full()) {
    std::fputs("bench_coupling_step: the arm does not press on its wall, or is told too little\n",
               stderr);
    return false;
  }
  bench::print(bench::compare("arm half, " + name, "ns", {bench::Goal::Of::Value, goal_ns}, ours,
                              reference));
  return true;
}

}  // namespace

int main() {
  for (const coupling::Scheme scheme : coupling::kSchemes) {
    const bool is_ours =
        scheme == coupling::Scheme::GhostPoint || scheme == coupling::Scheme::Composite;
    const double goal_ns = is_ours ? 400 : 1000;
    if (!run(std::string(to_string(scheme)), coupling::make_arm_coupling(scheme, {}), goal_ns)) {
      return 1;
    }
  }
  auto guarded = std::make_unique<coupling::PassivityGuard>(
      coupling::make_arm_coupling(coupling::Scheme::GhostPoint, {}), coupling::PassivitySettings{});
  if (!run("ghost-point with passivity", std::move(guarded), 400)) return 1;
  auto one_end = std::make_unique<coupling::TwoPortArm>(
      coupling::make_arm_coupling(coupling::Scheme::RemoteForce, {}),
      coupling::PassivitySettings{});
  if (!run("remote-force with two-port", std::move(one_end), 1000)) return 1;
  auto planes = coupling::make_arm_coupling(coupling::Scheme::ConstraintPlane, {});
  return run("constraint-plane, corner", std::move(planes), 1000, true) ? 0 : 1;
}
