#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/coupling/scheme.hpp"

// Defects of the printed servo callback (docs/thesis-defects.md), each shown there and absent here.
namespace thimble::coupling {
namespace {

constexpr double kWall_m = 0.015;

ConstraintPlane wall(Direction3 normal, double offset_m) {
  return {.normal = normal, .offset_m = offset_m, .surface = {}};
}

// Either arm half on a bench of 1 ms ticks; the callback has had its first tick, which erases.
class Bench {
 public:
  explicit Bench(Scheme scheme, bool is_past_first_tick = true)
      : arm_(make_arm_coupling(scheme, {})) {
    arm_->reset({}, {});
    if (is_past_first_tick) tick({}, {}, std::nullopt);
  }
  ArmOutput told(Position3 tip, const std::vector<ConstraintPlane>& planes,
                 Velocity3 velocity = {}) {
    return tick(tip, velocity, planes);
  }
  void restart_world() { ++session_; }

 private:
  ArmOutput tick(Position3 tip, Velocity3 velocity,
                 const std::optional<std::vector<ConstraintPlane>>& planes) {
    now_ = now_ + std::chrono::milliseconds(1);
    ArmInput input{.now = now_, .dt = std::chrono::milliseconds(1), .tip = tip};
    input.tip_velocity = velocity;
    ConstraintSet set;
    if (planes) {
      set.sequence = ++replies_;
      set.session = session_;
      for (const ConstraintPlane& plane : *planes) set.planes.push_back(plane);
      input.fresh = &set;
    }
    return arm_->step(input);
  }

  std::unique_ptr<ArmCoupling> arm_;
  MonotonicTime now_{};
  std::uint64_t replies_{0};
  std::uint32_t session_{1};
};

struct Both {
  ArmOutput ours;
  ArmOutput printed;
};

// The same steps with both arm halves.
template <class Steps>
Both with_both(Steps steps) {
  Bench ours(Scheme::GhostPoint);
  Bench printed(Scheme::ThesisLiteral);
  return {steps(ours), steps(printed)};
}

TEST(ThesisDefect, TheFingerIsLeftInsideTheWallOnAllSixFaces) {
  int printed_outside = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      Direction3 normal;
      normal[axis] = side;
      Position3 tip;
      tip[axis] = side * 0.020;
      const Both out =
          with_both([&](Bench& bench) { return bench.told(tip, {wall(normal, kWall_m)}); });
      EXPECT_NEAR(dot(normal, out.ours.sample.hand) - kWall_m, 0.0005, 1e-12);
      EXPECT_LT(dot(normal, out.ours.force), -0.3);
      printed_outside += dot(normal, out.printed.sample.hand) < kWall_m ? 1 : 0;
    }
  }
  EXPECT_EQ(printed_outside, 3);
}

TEST(ThesisDefect, APlaneThatMovesUnderTheSameBitGivesNoKick) {
  const auto steps = [](Bench& bench) {
    bench.told({kWall_m + 0.0004, 0, 0}, {wall({1, 0, 0}, kWall_m)});
    return bench.told({kWall_m + 0.0004, 0, 0}, {wall({1, 0, 0}, kWall_m - 0.030)});
  };
  const Both out = with_both(steps);
  EXPECT_NEAR(out.ours.force.x, -0.32, 0.02) << "as before the plane moved";
  EXPECT_LT(out.printed.force.x, -24);
}

TEST(ThesisDefect, ARestartedWorldGivesNoKick) {
  const auto steps = [](Bench& bench) {
    bench.told({kWall_m + 0.0004, 0, 0}, {wall({1, 0, 0}, kWall_m)});
    bench.restart_world();
    return bench.told({kWall_m + 0.0004, 0, 0}, {wall({1, 0, 0}, -kWall_m)});
  };
  const Both out = with_both(steps);
  EXPECT_NEAR(out.ours.force.x, -0.32, 0.09);
  EXPECT_LT(out.printed.force.x, -24);
}

TEST(ThesisDefect, AWallNeverPullsTheFingerThatLeaves) {
  const auto steps = [](Bench& bench) {
    bench.told({kWall_m + 0.0004, 0, 0}, {wall({1, 0, 0}, kWall_m)});
    return bench.told({kWall_m + 0.0001, 0, 0}, {wall({1, 0, 0}, kWall_m)}, {-0.5, 0, 0});
  };
  const Both out = with_both(steps);
  EXPECT_EQ(out.ours.force, Force3{});
  EXPECT_GT(out.printed.force.x, 4);
}

TEST(ThesisDefect, AnOffsetLeftByOneWallNeverDrawsIntoTheOpposite) {
  const auto steps = [](Bench& bench) {
    bench.told({-0.030, 0, 0}, {wall({-1, 0, 0}, kWall_m)});
    bench.told({-0.010, 0, 0}, {});
    // The frame came along by some 15 mm: this hand is 0.3 mm inside the wall at +x.
    const ArmOutput before = bench.told({0, 0, 0}, {});
    const Position3 tip{kWall_m + 0.0003 - before.offset.x, 0, 0};
    return bench.told(tip, {wall({1, 0, 0}, kWall_m)});
  };
  const Both out = with_both(steps);
  EXPECT_GT(out.ours.offset.x, 0.010);
  EXPECT_LT(out.ours.force.x, -0.2);
  EXPECT_GT(out.printed.offset.x, 0.010);
  EXPECT_GT(out.printed.force.x, 0.3) << "into the wall";
}

// How a frame that was displaced along two axes comes back.
struct WayBack {
  Displacement3 end{};
  double longest_step_m{0};
  double widest_m{0};  // from the straight line between its start and the origin
};

WayBack way_back(Scheme scheme) {
  Bench bench(scheme);
  bench.told({0.035, 0.020, 0}, {wall({1, 0, 0}, kWall_m), wall({0, 1, 0}, kWall_m)});
  bench.restart_world();  // voids the walls, else the frame would stop short of them
  const Displacement3 start = bench.told({}, {}).offset;
  WayBack out{.end = start};
  for (int i = 0; i < 1500; ++i) {
    const Displacement3 next = bench.told({}, {}).offset;
    out.longest_step_m = std::max(out.longest_step_m, norm(next - out.end));
    const double area = std::abs(next.x * start.y - next.y * start.x);
    out.widest_m = std::max(out.widest_m, area / norm(start));
    out.end = next;
  }
  return out;
}

TEST(ThesisDefect, TheFrameReturnsAllTheWayInAStraightLine) {
  const WayBack ours = way_back(Scheme::GhostPoint);
  EXPECT_EQ(ours.end, Displacement3{});
  EXPECT_NEAR(ours.longest_step_m, 0.025e-3, 1e-12) << "25 mm/s in a tick of 1 ms";
  EXPECT_LT(ours.widest_m, 1e-12);
  const WayBack printed = way_back(Scheme::ThesisLiteral);
  EXPECT_NEAR(std::abs(printed.end.x), 0.002, 0.0003);
  EXPECT_NEAR(std::abs(printed.end.y), 0.002, 0.0003);
  EXPECT_GT(printed.longest_step_m, 0.249e-3);
  EXPECT_GT(printed.widest_m, 0.001);
}

TEST(ThesisDefect, AConstraintOfTheFirstTickIsNotErased) {
  Bench ours(Scheme::GhostPoint, /*is_past_first_tick=*/false);
  Bench printed(Scheme::ThesisLiteral, /*is_past_first_tick=*/false);
  const std::vector<ConstraintPlane> planes{wall({1, 0, 0}, kWall_m)};
  EXPECT_LT(ours.told({0.0153, 0, 0}, planes).force.x, -0.2);
  EXPECT_EQ(printed.told({0.0153, 0, 0}, planes).force, Force3{});
}

}  // namespace
}  // namespace thimble::coupling
