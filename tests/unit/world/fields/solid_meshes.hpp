#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "daemon/world/fields/mesh.hpp"

namespace thimble::world::testing {

inline Displacement3 cross_of(Displacement3 a, Displacement3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Two triangles a face, outside out.
inline Mesh box_mesh(Position3 low, Position3 high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.corners.push_back({(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                            (i & 4) != 0 ? high.z : low.z});
  }
  for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
           {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

// An octahedron, its faces cut in four so often and its corners put at `radius_m(direction)`.
template <class Radius>
Mesh star_mesh(int cuts, const Radius& radius_m) {
  Mesh mesh;
  mesh.corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int cut = 0; cut < cuts; ++cut) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), 0U);
      if (is_new) {
        at->second = static_cast<std::uint32_t>(mesh.corners.size());
        Displacement3 way =
            0.5 * ((mesh.corners[a] - Position3{}) + (mesh.corners[b] - Position3{}));
        mesh.corners.push_back(Position3{} + (1 / norm(way)) * way);
      }
      return at->second;
    };
    std::vector<Mesh::Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Position3& corner : mesh.corners) {
    corner = Position3{} + radius_m(corner - Position3{}) * (corner - Position3{});
  }
  return mesh;
}
inline Mesh ball_mesh(int cuts, double radius_m) {
  return star_mesh(cuts, [radius_m](Displacement3) { return radius_m; });
}

inline Mesh both(Mesh a, const Mesh& b) {
  const auto before = static_cast<std::uint32_t>(a.corners.size());
  a.corners.insert(a.corners.end(), b.corners.begin(), b.corners.end());
  for (const auto& [i, j, k] : b.triangles) {
    a.triangles.push_back({before + i, before + j, before + k});
  }
  return a;
}
inline Mesh inside_out(Mesh mesh) {
  for (Mesh::Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}
inline Mesh moved(Mesh mesh, Displacement3 by) {
  for (Position3& corner : mesh.corners) corner = corner + by;
  return mesh;
}

// How often the surface goes round a place: its solid angle over 4π (Van Oosterom and Strackee
// 1983).
inline double winding_of(const Mesh& mesh, Position3 at) {
  double angle_rad = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Displacement3 a = mesh.corners[i] - at;
    const Displacement3 b = mesh.corners[j] - at;
    const Displacement3 c = mesh.corners[k] - at;
    const double below = norm(a) * norm(b) * norm(c) + dot(a, b) * norm(c) + dot(b, c) * norm(a) +
                         dot(c, a) * norm(b);
    angle_rad += 2 * std::atan2(dot(a, cross_of(b, c)), below);
  }
  return angle_rad / (4 * std::numbers::pi);
}

}  // namespace thimble::world::testing
