#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/cam/engine/bit_functions.hpp"
#include "sim/model/cam/engine/engine.hpp"
#include "sim/model/cam/engine/vector_kernels.hpp"

namespace thimble::sim::cam {

// A lookup table as operations on whole planes (bit-sliced): what VectorKernels::run_ops takes.
// Blocks 0 to 15 are the layers' bits, 16 to 31 what becomes of them, the others room for
// what is needed twice. Only the first layer of those with the same function has operations, none
// where a layer stays as it is.
struct PlaneRule {
  static constexpr std::size_t kFirstOutput = kPlanes;
  static constexpr std::size_t kFirstRoom = 2 * kPlanes;

  std::vector<PlaneOp> ops{};
  std::size_t rooms{0};
  LayerBits inputs{0};                          // layers that some operation looks at
  std::array<std::uint8_t, kPlanes> same_as{};  // the layer that has the same function, or itself
};

// What of a table can be seen without a compiler.
struct TableShape {
  LayerBits kept{0};    // layers whose bit is the table's own bit
  LayerBits inputs{0};  // layers that any other output depends on
};
[[nodiscard]] TableShape shape_of(std::span<const std::uint16_t> table);

// A rule of at most so many operations; none where the table needs more in each order of its inputs
// that is tried. Pure; one to thirty milliseconds.
// SOURCE: ours; four times what is worth it (VectorKernels::worth_ops).
inline constexpr std::size_t kMostPlaneOps = 1024;
[[nodiscard]] std::optional<PlaneRule> compile_rule(std::span<const std::uint16_t> table,
                                                    std::size_t most_ops = kMostPlaneOps);

// Whether the rule, run by these kernels, does with each of the 65,536 values of a site what the
// table says.
[[nodiscard]] bool does_as_table(const PlaneRule& rule, std::span<const std::uint16_t> table,
                                 const VectorKernels& kernels);

}  // namespace thimble::sim::cam
