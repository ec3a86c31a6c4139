#include "daemon/world/plane_projection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/random_planes.hpp"

namespace thimble::world {
namespace {

using test::RandomPlanes;

// Dykstra's alternating projections: slow, and knows nothing of sets of three.
Displacement3 oracle(const PastPlanes& planes, int rounds) {
  Displacement3 at{};
  std::array<double, kMaxContactPlanes> pull{};
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const Direction3 n = planes[i].normal;
      const double past_m = dot(n, at) + planes[i].past_m;
      const double next = std::max(0.0, pull[i] + past_m);
      at -= along<DisplacementTag>(n, next - pull[i]);
      pull[i] = next;
    }
  }
  return -at;
}

double left_m(const PastPlanes& planes, Displacement3 past) {
  double left = 0;
  for (const PastPlane& plane : planes)
    left = std::max(left, plane.past_m - dot(plane.normal, past));
  return left;
}

// Its conditions, of random planes that leave a place: admissible, no push away from a plane, none
// of a plane that is not touched, and at most three.
TEST(PlaneProjection, MeetsTheConditionsOfAGodObject) {
  RandomPlanes random(1);
  std::array<int, 4> seen{};
  for (std::size_t i = 0; i < 200'000; ++i) {
    const PastPlanes planes = random.around_a_free_place(1 + i % kMaxContactPlanes);
    const PlaneProjection sut = project(planes);
    ASSERT_TRUE(sut.has_place) << i;
    Displacement3 sum{};
    std::size_t pressing = 0;
    for (std::size_t k = 0; k < planes.size(); ++k) {
      ASSERT_GE(sut.share[k], 0);
      sum += along<DisplacementTag>(planes[k].normal, sut.share[k]);
      if (!(sut.share[k] > 0)) continue;
      ++pressing;
      const double gap_m = dot(planes[k].normal, sut.past) - planes[k].past_m;
      ASSERT_NEAR(gap_m, 0, 1e-8 * std::max(1.0, sut.share[k])) << i;
    }
    ASSERT_EQ(sum, sut.past);
    ASSERT_LE(pressing, 3U);
    ASSERT_LE(left_m(planes, sut.past), 2e-9) << i;
    ++seen[pressing];
  }
  EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 1000) << "each number of planes is tried";
}

TEST(PlaneProjection, IsTheNearestPlaceThatAlternatingProjectionsFind) {
  RandomPlanes random(2);
  int compared = 0;
  for (std::size_t i = 0; i < 5000; ++i) {
    const PastPlanes planes = random.around_a_free_place(1 + i % kMaxContactPlanes);
    const Displacement3 expected = oracle(planes, 4000);
    if (left_m(planes, expected) > 1e-10) continue;  // has not converged: a sharp edge
    ++compared;
    ASSERT_NEAR(norm(project(planes).past - expected), 0, 1e-6) << i;
  }
  EXPECT_GT(compared, 3500);
}

// No place that a dense cloud of them tries is both free and nearer.
TEST(PlaneProjection, NoFreePlaceIsNearer) {
  RandomPlanes random(3);
  for (std::size_t i = 0; i < 300; ++i) {
    const PastPlanes planes = random.around_a_free_place(1 + i % kMaxContactPlanes);
    const PlaneProjection sut = project(planes);
    for (int k = 0; k < 2000; ++k) {
      const Displacement3 past = sut.past + random.displacement(0.3 * norm(sut.past) + 1e-4);
      if (left_m(planes, past) > 0) continue;
      ASSERT_GE(norm(past), norm(sut.past) - 2e-9) << i;
    }
  }
}

TEST(PlaneProjection, ParallelAndContradictingPlanesAreTotal) {
  const Direction3 x{1, 0, 0};
  const Direction3 back{-1, 0, 0};
  PastPlanes twins;
  for (const double past_m : {0.001, 0.003, 0.002}) twins.push_back({x, past_m});
  EXPECT_EQ(project(twins).past, (Displacement3{0.003, 0, 0}));
  PastPlanes slot;  // two millimetres too narrow, the hand 0.5 mm off its middle
  slot.push_back({x, 0.0015});
  slot.push_back({back, 0.0005});
  const PlaneProjection held = project(slot);
  EXPECT_FALSE(held.has_place);
  EXPECT_NEAR(held.past.x, 0.001, 1e-15);
  PastPlanes wide;
  wide.push_back({x, 0.0015});
  wide.push_back({back, -0.0015});
  EXPECT_TRUE(project(wide).has_place) << "a slot without width";
  EXPECT_EQ(project(wide).past, (Displacement3{0.0015, 0, 0}));
  EXPECT_EQ(project({}).past, Displacement3{});
}

// Any number of planes however they lie, parallel and nearly so included.
TEST(PlaneProjection, DegenerateNormalsGiveFiniteAnswersThatKeepTheirPromise) {
  RandomPlanes random(4);
  int contradictions = 0;
  for (std::size_t i = 0; i < 200'000; ++i) {
    const PastPlanes planes = random.degenerate(1 + i % kMaxContactPlanes);
    const PlaneProjection sut = project(planes);
    ASSERT_TRUE(is_finite(sut.past)) << i;
    if (!sut.has_place) {
      ++contradictions;
      continue;
    }
    ASSERT_LE(left_m(planes, sut.past), 2e-6) << i;
  }
  EXPECT_GT(contradictions, 1000);
}

TEST(PlaneProjection, MirroredToTheBitPermutedToRounding) {
  RandomPlanes random(5);
  for (std::size_t i = 0; i < 20'000; ++i) {
    const PastPlanes planes = random.around_a_free_place(1 + i % kMaxContactPlanes);
    const Displacement3 past = project(planes).past;
    PastPlanes mirrored;
    PastPlanes turned;
    for (const auto& [n, past_m] : planes) mirrored.push_back({{-n.x, n.y, -n.z}, past_m});
    for (std::size_t k = planes.size(); k > 0; --k) {
      const auto& [n, past_m] = planes[k - 1];
      turned.push_back({{n.z, n.x, n.y}, past_m});
    }
    ASSERT_EQ(project(mirrored).past, (Displacement3{-past.x, past.y, -past.z})) << i;
    const Displacement3 other = project(turned).past;
    ASSERT_NEAR(norm(Displacement3{other.y, other.z, other.x} - past), 0, 1e-7) << i;
  }
}

}  // namespace
}  // namespace thimble::world
