#pragma once

#include <cstdint>
#include <optional>

#include "daemon/world/fields/distance_field.hpp"
#include "daemon/world/fields/mesh.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// Ours: 261³ numbers are 68 MiB, and take a minute.
inline constexpr std::uint32_t kLeastResolution = 8;
inline constexpr std::uint32_t kMostResolution = 256;

struct MeshFieldOptions {
  std::uint32_t resolution{64};  // steps along the mesh's longest edge, kLeast- to kMostResolution
  double longest_m{0.06};        // that edge, where unit_m is not said
  std::optional<double> unit_m{};  // of the mesh's numbers
  Position3 center{};              // where the middle of the box around the mesh comes to lie
};

// The signed distance field of a mesh: at every node of a lattice that reaches two steps beyond the
// box around it, the distance to the nearest triangle (MeshDistance), below 0 where the surface
// goes round the node (find_winding()). Within three steps of the surface it is exact at the nodes;
// further off it is the distance to one of the triangles nearest to eight places close by, so never
// too small. Between nodes it is off by no more than a step times √3/2, which only sharp edges come
// near. Matter thinner than a step may have no node in it, and is then not there.
//
// Not RT: about 1 s for 30,000 triangles and a resolution of 64. Bounded by kMaxTriangles,
// kMostResolution, the trials of find_winding(), and 2^31 looks of MeshDistance, which are minutes.
// Errors: those of check_closed(), with places as the mesh has them; InvalidArgument: part of it is
// inside out, or it is too large or small; TooLarge: it takes too long.
[[nodiscard]] Result<DistanceField> make_field(Mesh mesh, const MeshFieldOptions& options);

}  // namespace thimble::world
