#include "daemon/world/fields/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

#include "daemon/world/fields/place_text.hpp"

namespace thimble::world {
namespace {

// Less than this share of a cube as long as the mesh is nothing: its faces lie in one plane.
constexpr double kLeastVolumeShare = 1e-9;

// One side of a triangle, its ends in order; `is_forth` where the triangle runs along it so.
struct Side {
  std::uint32_t low{0};
  std::uint32_t high{0};
  bool is_forth{false};

  [[nodiscard]] bool is_beside(const Side& other) const noexcept {
    return low == other.low && high == other.high;
  }
};

std::vector<Side> sorted_sides(const Mesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangle[i];
      const std::uint32_t to = triangle[(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.is_forth) < std::tie(b.low, b.high, b.is_forth);
  });
  return sides;
}

[[nodiscard]] std::string place_of(const Mesh& mesh, const Side& side) {
  return "the edge from " + text_of(mesh.corners[side.low]) + " to " +
         text_of(mesh.corners[side.high]);
}

[[nodiscard]] Result<void> check_sides(const Mesh& mesh) {
  const std::vector<Side> sides = sorted_sides(mesh);
  for (std::size_t first = 0, next = 0; first < sides.size(); first = next) {
    std::size_t forth = 0;
    for (next = first; next < sides.size() && sides[next].is_beside(sides[first]); ++next) {
      if (sides[next].is_forth) ++forth;
    }
    const std::size_t all = next - first;
    if (2 * forth == all) continue;
    const std::string where = place_of(mesh, sides[first]);
    if (all % 2 == 1) {
      return fail(Errc::InvalidArgument, "mesh: it is open at " + where + ", which " +
                                             std::to_string(all) + " of its triangles have");
    }
    return fail(Errc::InvalidArgument, "mesh: triangles are turned against each other at " + where);
  }
  return {};
}

// Of the matter within, by the divergence theorem: a sixth of a·(b × c) of every triangle.
[[nodiscard]] double volume_m3(const Mesh& mesh, Position3 middle) noexcept {
  double six_m3 = 0;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    const Displacement3 a = mesh.corners[triangle[0]] - middle;
    const Displacement3 b = mesh.corners[triangle[1]] - middle;
    const Displacement3 c = mesh.corners[triangle[2]] - middle;
    six_m3 += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
              a.z * (b.x * c.y - b.y * c.x);
  }
  return six_m3 / 6;
}

}  // namespace

void weld(Mesh& mesh) {
  const std::vector<Position3>& corners = mesh.corners;
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const auto& [a, b] = std::tie(corners[i], corners[j]);
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  });
  std::vector<std::uint32_t> becomes(corners.size());
  std::vector<Position3> kept;
  for (const std::uint32_t i : order) {
    if (kept.empty() || !(kept.back() == corners[i])) kept.push_back(corners[i]);
    becomes[i] = static_cast<std::uint32_t>(kept.size() - 1);
  }
  for (Mesh::Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = becomes[corner];
  }
  std::erase_if(mesh.triangles, [](const Mesh::Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  });
  mesh.corners = std::move(kept);
}

MeshBox box_around(const Mesh& mesh) noexcept {
  MeshBox box{mesh.corners.front(), mesh.corners.front()};
  for (const Position3& corner : mesh.corners) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], corner[axis]);
      box.high[axis] = std::max(box.high[axis], corner[axis]);
    }
  }
  return box;
}

Result<void> check_closed(const Mesh& mesh) {
  if (mesh.triangles.empty()) return fail(Errc::InvalidArgument, "mesh: it has no triangles");
  if (auto good = check_sides(mesh); !good) return good;
  const auto& [low, high] = box_around(mesh);
  const Displacement3 edges = high - low;
  const double longest_m = std::max({edges.x, edges.y, edges.z});
  const double within_m3 = volume_m3(mesh, low + 0.5 * edges);
  if (!(std::abs(within_m3) > kLeastVolumeShare * longest_m * longest_m * longest_m)) {
    return fail(Errc::InvalidArgument, "mesh: there is no room within it");
  }
  if (within_m3 > 0) return {};
  return fail(Errc::InvalidArgument, "mesh: it is inside out; turn all of its triangles");
}

}  // namespace thimble::world
