#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Ours: a scan of a hand has a tenth of it; 48 MiB while it loads.
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << 20;

// A surface of triangles. Its corners are places in the unit of whoever made it; seen from outside,
// a triangle's corners go round counterclockwise.
struct Mesh {
  using Triangle = std::array<std::uint32_t, 3>;  // of indices into corners
  std::vector<Position3> corners{};
  std::vector<Triangle> triangles{};
};

// Makes one corner of those at the very same place, and leaves out triangles that then have the
// same corner twice: files repeat the corners that triangles share.
void weld(Mesh& mesh);

// Whether a welded mesh encloses matter, so that every place is inside or outside: each edge is run
// along as often one way as the other, and the volume within is above 0. Parts may lie within each
// other and overlap.
//
// Errors: InvalidArgument, with the first place that is wrong: open, turned against each other,
// inside out, or nothing within.
[[nodiscard]] Result<void> check_closed(const Mesh& mesh);

// The edges of the box around it, which lies along the axes; `mesh` has a corner.
struct MeshBox {
  Position3 low{};
  Position3 high{};
};
[[nodiscard]] MeshBox box_around(const Mesh& mesh) noexcept;

}  // namespace thimble::world
