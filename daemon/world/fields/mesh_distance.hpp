#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "daemon/world/fields/mesh.hpp"
#include "hal/base/geometry.hpp"

namespace thimble::world {

// Square of the distance from a place to the nearest of a triangle: of its face, its sides or its
// corners (Ericson, Real-Time Collision Detection, 5.1.5). Triangles without area have sides.
[[nodiscard]] double squared_distance_m2(Position3 at,
                                         const std::array<Position3, 3>& triangle) noexcept;

// The distance from places to the nearest triangle of a mesh, exact to rounding: a tree of boxes,
// halved at the middle triangle along the longest axis, of which boxes beyond what was found are
// left out.
//
// Thread: one. Not RT. Ownership: keeps a copy of the triangles. Memory: 72 bytes a triangle and 64
// a box, about half as many.
class MeshDistance {
 public:
  // `mesh` has a triangle.
  explicit MeshDistance(const Mesh& mesh);

  struct Nearest {
    double distance_m{0};
    std::uint32_t triangle{0};  // a number of its own, for guesses
  };
  // `guesses`: triangles that may be near, such as what was nearest to places beside this one; the
  // better they are, the sooner it is found.
  [[nodiscard]] Nearest find(Position3 at, std::span<const std::uint32_t> guesses = {});
  // The nearest of these alone; there is one.
  [[nodiscard]] Nearest nearest_of(Position3 at,
                                   std::span<const std::uint32_t> triangles) const noexcept;
  // How many boxes find() has looked into, which is what takes its time.
  [[nodiscard]] std::uint64_t looks() const noexcept { return looks_; }

 private:
  using Corners = std::array<Position3, 3>;
  // A leaf has triangles [first, first + count); another has boxes `first` and `first + 1`.
  struct Box {
    Position3 low{};
    Position3 high{};
    std::uint32_t first{0};
    std::uint32_t count{0};
  };
  [[nodiscard]] Box around(std::uint32_t first, std::uint32_t end) const noexcept;
  [[nodiscard]] static double squared_m2(const Box& box, Position3 at) noexcept;

  std::vector<Corners> triangles_{};
  std::vector<Box> boxes_{};
  std::uint64_t looks_{0};
};

}  // namespace thimble::world
