#include "tests/unit/coupling/pushed_edge.hpp"

#include <gtest/gtest.h>

#include <string>

#include "daemon/world/voxel_world.hpp"
#include "tests/support/arm_watch.hpp"
#include "tests/support/guided_hand.hpp"

// docs/pushed-edge.md once more, with the whole loop and the simulated arm in place of a finger on
// one axis.
namespace thimble {
namespace {

using coupling::testing::Teeth;
using test::ClosedLoop;

// Everything from x cell `front` on is filled; gives way by a layer when pressed with 1 N.
class Edge {
 public:
  Edge(ClosedLoop& loop, std::int32_t front)
      : loop_(loop), world_(dynamic_cast<world::VoxelWorld&>(loop.world())), front_(front) {
    for (std::int32_t x = 0; x < cells(); ++x) set_layer(x, x >= front_);
  }
  void give_way() {
    const double hand_m = loop_.frame().tip.x + loop_.frame().offset.x;
    if (800 * (hand_m - world_.grid()->face_m(0, front_)) < 1) return;
    set_layer(front_++, false);
    ++layers_;
  }
  [[nodiscard]] int layers() const { return layers_; }

 private:
  [[nodiscard]] std::int32_t cells() const {
    return static_cast<std::int32_t>(world_.info().cells[0]);
  }
  void set_layer(std::int32_t x, bool is_filled) {
    for (world::Cell cell{x, 0, 0}; cell.y < cells(); ++cell.y) {
      for (cell.z = 0; cell.z < cells(); ++cell.z) world_.set_cell(cell, is_filled);
    }
  }
  ClosedLoop& loop_;
  world::VoxelWorld& world_;
  std::int32_t front_;
  int layers_{0};
};

struct Felt {
  Teeth teeth;
  int layers{0};
  std::string breach;
};

Felt push(int cells, double workspace_m) {
  ClosedLoop loop({"world.source=box:" + std::to_string(cells),
                   "world.workspace_m=" + std::to_string(workspace_m), "arm.hand.motion=still"});
  Edge edge(loop, cells / 2 + cells / 16);
  loop.run_until_driven();
  test::GuidedHand hand(loop, {.stiffness = {200}, .damping = {4}, .speed_m_per_s = 0.05});
  test::ArmWatch watch(loop);
  Felt felt;
  hand.go({0.030, 0, 0}, [&] {
    watch.see();
    edge.give_way();
    if (edge.layers() > 0) felt.teeth.add(-loop.frame().wish.x);
  });
  felt.layers = edge.layers();
  felt.breach = watch.breach();
  EXPECT_EQ(loop.snapshot().faults, 0U);
  return felt;
}

TEST(PushedEdge, OnTheSimulatedArmTooEachCoarseCellIsAToothToNothing) {
  const Felt sut = push(64, 0.090);  // 1.4 mm
  EXPECT_GT(sut.layers, 8);
  EXPECT_NEAR(sut.teeth.to_nothing(), sut.layers, 2);
  EXPECT_LT(sut.teeth.largest_newton(), 2);
  EXPECT_EQ(sut.breach, "");
}

TEST(PushedEdge, OnTheSimulatedArmTooFineCellsAreFeltAsOneSurface) {
  const Felt sut = push(256, 0.064);  // 0.25 mm
  EXPECT_GT(sut.layers, 50);
  EXPECT_EQ(sut.teeth.to_nothing(), 0);
  EXPECT_LT(sut.teeth.count(), sut.layers / 4);
  EXPECT_EQ(sut.breach, "");
}

}  // namespace
}  // namespace thimble
