#include "daemon/world/fields/mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "daemon/world/fields/mesh_distance.hpp"
#include "daemon/world/fields/mesh_winding.hpp"
#include "solid_meshes.hpp"
#include "tests/support/random_planes.hpp"

namespace thimble::world {
namespace {

using test::RandomPlanes;
using namespace testing;  // NOLINT(google-build-using-namespace)

std::string refusal_of(Mesh mesh) {
  weld(mesh);
  const auto sut = check_closed(mesh);
  return sut ? "" : sut.error().message;
}

TEST(Mesh, WeldsCornersAtTheSamePlaceAndDropsWhatIsNoTriangle) {
  Mesh sut;  // as STL has it: each triangle with corners of its own
  const Mesh box = box_mesh({0, 0, -0.0}, {1, 2, 3});
  for (const Mesh::Triangle& t : box.triangles) {
    const auto first = static_cast<std::uint32_t>(sut.corners.size());
    for (const std::uint32_t corner : t) sut.corners.push_back(box.corners[corner]);
    sut.triangles.push_back({first, first + 1, first + 2});
  }
  sut.corners.push_back({0, 0, 0.0});
  sut.triangles.push_back({0, 1, static_cast<std::uint32_t>(sut.corners.size() - 1)});
  sut.triangles.push_back({5, 5, 5});
  weld(sut);
  EXPECT_EQ(sut.corners.size(), 8U);
  EXPECT_LE(sut.triangles.size(), 13U);
  EXPECT_EQ(refusal_of(box), "");
}

TEST(Mesh, IsRefusedWithThePlaceWhereItIsOpenOrTurned) {
  Mesh open = box_mesh({0, 0, 0}, {1, 2, 3});
  open.triangles.pop_back();
  EXPECT_EQ(
      refusal_of(open),
      "mesh: it is open at the edge from (0, 0, 3) to (0, 2, 3), which 1 of its triangles have");
  Mesh turned = box_mesh({0, 0, 0}, {1, 2, 3});
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_EQ(
      refusal_of(turned),
      "mesh: triangles are turned against each other at the edge from (0, 0, 0) to (0, 0, 3)");
  EXPECT_EQ(refusal_of(inside_out(ball_mesh(1, 1))),
            "mesh: it is inside out; turn all of its triangles");
  EXPECT_EQ(refusal_of({}), "mesh: it has no triangles");
  Mesh flat = both(box_mesh({0, 0, 0}, {1, 1, 0}), {});
  EXPECT_EQ(refusal_of(flat), "mesh: there is no room within it");
}

TEST(Mesh, MayHaveHollowsAndPartsThatOverlapOrTouchAlongAnEdge) {
  EXPECT_EQ(refusal_of(both(ball_mesh(2, 1), inside_out(ball_mesh(2, 0.5)))), "");
  EXPECT_EQ(refusal_of(both(ball_mesh(2, 1), moved(ball_mesh(2, 1), {0.7, 0.1, 0}))), "");
  EXPECT_EQ(refusal_of(both(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({1, 1, 0}, {2, 2, 1}))), "");
}

TEST(MeshDistance, OfATriangleIsThatToItsNearestPoint) {
  RandomPlanes random(11);
  for (int i = 0; i < 300; ++i) {
    std::array<Position3, 3> triangle{};
    for (Position3& corner : triangle) corner = Position3{} + random.displacement(1);
    if (i % 5 == 0) triangle[2] = triangle[0] + 0.3 * (triangle[1] - triangle[0]);  // no area
    if (i % 25 == 0) triangle[1] = triangle[2] = triangle[0];
    const Position3 at = Position3{} + random.displacement(1.5);
    const double sut_m = std::sqrt(squared_distance_m2(at, triangle));
    double least_m = 10;
    constexpr int kParts = 60;
    for (int a = 0; a <= kParts; ++a) {
      for (int b = 0; a + b <= kParts; ++b) {
        const Position3 on = triangle[0] + (double{1} * a / kParts) * (triangle[1] - triangle[0]) +
                             (double{1} * b / kParts) * (triangle[2] - triangle[0]);
        least_m = std::min(least_m, norm(at - on));
      }
    }
    ASSERT_LE(sut_m, least_m + 1e-9);
    ASSERT_GE(sut_m, least_m - 0.06) << "a sixtieth of the longest side";
  }
}

TEST(MeshDistance, IsThatToTheNearestOfAllTriangles) {
  RandomPlanes random(12);
  Mesh soup;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Position3 at = Position3{} + random.displacement(1);
    for (int k = 0; k < 3; ++k) soup.corners.push_back(at + random.displacement(0.1));
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  MeshDistance sut(soup);
  for (int i = 0; i < 1000; ++i) {
    const Position3 at = Position3{} + random.displacement(1.5);
    double least_m2 = 100;
    for (const auto& [a, b, c] : soup.triangles) {
      least_m2 = std::min(
          least_m2, squared_distance_m2(at, {soup.corners[a], soup.corners[b], soup.corners[c]}));
    }
    const MeshDistance::Nearest found = sut.find(at);
    ASSERT_DOUBLE_EQ(found.distance_m, std::sqrt(least_m2));
    const std::array<std::uint32_t, 2> guesses{static_cast<std::uint32_t>(i % 500), found.triangle};
    ASSERT_EQ(sut.find(at, guesses).distance_m, found.distance_m);
    ASSERT_EQ(sut.find(at, std::span(guesses).first(1)).distance_m, found.distance_m);
  }
  EXPECT_LT(sut.looks(), 3000U * 300) << "far fewer than all boxes";
}

// Each node against the solid angle, which no row and no rounding of corners is in.
void expect_winding(const Mesh& mesh, const MeshLattice& lattice) {
  const auto sut = find_winding(mesh, lattice);
  ASSERT_TRUE(sut);
  MeshDistance distance(mesh);
  const auto& [nx, ny, nz] = lattice.numbers;
  for (std::size_t i = 0; i < sut->size(); ++i) {
    const Position3 at = lattice.node(i % nx, i / nx % ny, i / nx / ny);
    if (distance.find(at).distance_m < 2e-4 * lattice.step_m) continue;
    ASSERT_EQ(std::lround(winding_of(mesh, at)), std::lround((*sut)[i])) << i;
  }
}

TEST(MeshWinding, IsTheSolidAngleOverThatOfASphere) {
  RandomPlanes random(13);
  for (int i = 0; i < 12; ++i) {
    const Mesh star = star_mesh(2, [&](Displacement3) { return 0.3 + 0.6 * random.uniform(0, 1); });
    const Mesh other = moved(ball_mesh(1, 0.5), random.displacement(0.3));
    const Mesh mesh = i % 2 == 0 ? both(star, other) : both(star, inside_out(other));
    expect_winding(mesh, {{-1.03, -1.01, -1.02}, 0.17, {14, 14, 14}});
  }
}

// Faces, edges and corners on the very rows: each is crossed once all the same.
TEST(MeshWinding, CountsRowsThroughEdgesAndCornersOnce) {
  const MeshLattice whole{{-2, -2, -2}, 1, {9, 9, 9}};
  expect_winding(box_mesh({0, 0, 0}, {3, 2, 4}), whole);
  expect_winding(both(box_mesh({0, 0, 0}, {2, 2, 2}), box_mesh({2, 0, 0}, {4, 2, 2})), whole);
  expect_winding(moved(star_mesh(1, [](Displacement3) { return 2; }), {2, 2, 2}), whole);
  expect_winding(moved(ball_mesh(0, 3), {2, 2, 2}), whole);
  const auto sut = find_winding(box_mesh({-0.5, 0, 0}, {2.5, 3, 3}), whole);
  ASSERT_TRUE(sut);
  double all = 0;
  for (const float w : *sut) all += w;
  EXPECT_EQ(all, 3 * 3 * 3) << "nodes on a face count for one of the two sides";
}

TEST(MeshWinding, HasABoundForWhatItTakes) {
  Mesh many = box_mesh({0, 0, 0}, {250, 250, 250});
  const auto faces = many.triangles;
  for (int i = 0; i < 2500; ++i) {
    many.triangles.insert(many.triangles.end(), faces.begin(), faces.end());
  }
  const auto sut = find_winding(many, {{-2, -2, -2}, 1, {255, 255, 255}});
  ASSERT_FALSE(sut);
  EXPECT_EQ(sut.error().code, Errc::TooLarge);
}

}  // namespace
}  // namespace thimble::world
