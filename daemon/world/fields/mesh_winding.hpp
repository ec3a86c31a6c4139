#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "daemon/world/fields/mesh.hpp"
#include "hal/base/result.hpp"

namespace thimble::world {

// A lattice of nodes, for what is taken of a mesh at each of them.
struct MeshLattice {
  Position3 first{};  // node (0, 0, 0)
  double step_m{0};
  std::array<std::uint32_t, 3> numbers{};  // of nodes along each axis, x fastest

  [[nodiscard]] Position3 node(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    return first + Displacement3{step_m * static_cast<double>(x), step_m * static_cast<double>(y),
                                 step_m * static_cast<double>(z)};
  }
};

// How often the surface goes round each node of the lattice: 0 outside, 1 within, more where parts
// overlap, less where one is inside out. The generalised winding number of Jacobson et al. 2013,
// which is whole for a closed mesh: counted along every row of nodes where triangles cross it,
// each +1 going in and −1 going out. Corners are put on whole fractions of a step across the row,
// and a row through an edge or a corner counts as a little beside it (Edelsbrunner and Mücke 1990),
// so that every crossing is found exactly once however the triangles lie; a node within 1e-4 steps
// of the surface may be taken for either side.
//
// `mesh` closed (check_closed()) and within the lattice, along each axis. Memory: 4 bytes a node,
// the result. Errors: TooLarge above 2^29 trials of a row and a triangle.
[[nodiscard]] Result<std::vector<float>> find_winding(const Mesh& mesh, const MeshLattice& lattice);

}  // namespace thimble::world
