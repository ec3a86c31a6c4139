#include "daemon/world/fields/mesh_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thimble::world {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
// Halves of kMaxTriangles down to a leaf are 18 deep; one box waits at each depth.
constexpr std::size_t kMostWaiting = 64;

double squared(Displacement3 way) noexcept { return dot(way, way); }

double to_side_m2(Position3 at, Position3 from, Position3 to) noexcept {
  const Displacement3 side = to - from;
  const double length_m2 = squared(side);
  if (!(length_m2 > 0)) return squared(at - from);
  const double share = std::clamp(dot(at - from, side) / length_m2, 0.0, 1.0);
  return squared(at - (from + share * side));
}

Displacement3 cross(Displacement3 a, Displacement3 b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace

double squared_distance_m2(Position3 at, const std::array<Position3, 3>& triangle) noexcept {
  const auto& [a, b, c] = triangle;
  const Displacement3 normal = cross(b - a, c - a);
  const double area_m4 = squared(normal);
  const auto is_within = [&](Position3 from, Position3 to) {
    return dot(cross(to - from, at - from), normal) >= 0;
  };
  if (area_m4 > 0 && is_within(a, b) && is_within(b, c) && is_within(c, a)) {
    const double past = dot(at - a, normal);
    return past * past / area_m4;
  }
  return std::min({to_side_m2(at, a, b), to_side_m2(at, b, c), to_side_m2(at, c, a)});
}

MeshDistance::MeshDistance(const Mesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (const Mesh::Triangle& t : mesh.triangles) {
    triangles_.push_back({mesh.corners[t[0]], mesh.corners[t[1]], mesh.corners[t[2]]});
  }
  boxes_.push_back(around(0, static_cast<std::uint32_t>(triangles_.size())));
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Box box = boxes_[i];
    if (box.count <= kLeafTriangles) continue;
    const Displacement3 edges = box.high - box.low;
    const std::size_t axis = edges.x >= edges.y && edges.x >= edges.z ? 0
                             : edges.y >= edges.z                     ? 1
                                                                      : 2;
    const auto begin = triangles_.begin() + box.first;
    const std::uint32_t half = box.count / 2;
    std::nth_element(
        begin, begin + half, begin + box.count, [axis](const Corners& a, const Corners& b) {
          return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
        });
    boxes_[i].first = static_cast<std::uint32_t>(boxes_.size());
    boxes_[i].count = 0;
    boxes_.push_back(around(box.first, box.first + half));
    boxes_.push_back(around(box.first + half, box.first + box.count));
  }
}

MeshDistance::Box MeshDistance::around(std::uint32_t first, std::uint32_t end) const noexcept {
  Box box{triangles_[first][0], triangles_[first][0], first, end - first};
  for (std::uint32_t i = first; i < end; ++i) {
    for (const Position3& corner : triangles_[i]) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], corner[axis]);
        box.high[axis] = std::max(box.high[axis], corner[axis]);
      }
    }
  }
  return box;
}

double MeshDistance::squared_m2(const Box& box, Position3 at) noexcept {
  double sum_m2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double out_m = std::max({box.low[axis] - at[axis], 0.0, at[axis] - box.high[axis]});
    sum_m2 += out_m * out_m;
  }
  return sum_m2;
}

MeshDistance::Nearest MeshDistance::nearest_of(
    Position3 at, std::span<const std::uint32_t> triangles) const noexcept {
  double best_m2 = std::numeric_limits<double>::infinity();
  std::uint32_t best = 0;
  for (const std::uint32_t triangle : triangles) {
    const double here_m2 = squared_distance_m2(at, triangles_[triangle]);
    if (!(here_m2 < best_m2)) continue;
    best_m2 = here_m2;
    best = triangle;
  }
  return {std::sqrt(best_m2), best};
}

MeshDistance::Nearest MeshDistance::find(Position3 at, std::span<const std::uint32_t> guesses) {
  struct Waiting {
    std::uint32_t box;
    double from_m2;
  };
  std::array<Waiting, kMostWaiting> waiting;
  std::size_t count = 0;
  waiting[count++] = {0, squared_m2(boxes_[0], at)};
  double best_m2 = std::numeric_limits<double>::infinity();
  std::uint32_t best = 0;
  const auto try_triangle = [&](std::uint32_t triangle) {
    const double here_m2 = squared_distance_m2(at, triangles_[triangle]);
    if (!(here_m2 < best_m2)) return;
    best_m2 = here_m2;
    best = triangle;
  };
  for (const std::uint32_t guess : guesses) try_triangle(guess);
  while (count > 0) {
    const Waiting next = waiting[--count];
    if (next.from_m2 >= best_m2) continue;
    ++looks_;
    const Box& box = boxes_[next.box];
    for (std::uint32_t i = box.first; i < box.first + box.count; ++i) try_triangle(i);
    if (box.count > 0) continue;
    const Waiting one{box.first, squared_m2(boxes_[box.first], at)};
    const Waiting other{box.first + 1, squared_m2(boxes_[box.first + 1], at)};
    const bool is_nearer = one.from_m2 <= other.from_m2;
    waiting[count++] = is_nearer ? other : one;
    waiting[count++] = is_nearer ? one : other;
  }
  return {std::sqrt(best_m2), best};
}

}  // namespace thimble::world
