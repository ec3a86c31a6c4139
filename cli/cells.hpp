#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace thimble::cli {

// The cells of a world as a daemon gave them: one of each `every` in each direction.
struct WorldCells {
  std::array<std::uint32_t, 3> sizes{};
  std::uint32_t every{1};
  std::string values{};  // x fastest, a byte each: 0 free, of pieces their numbers, else 1
  bool operator==(const WorldCells&) const = default;
};

// Ours: more than a daemon gives.
inline constexpr std::size_t kMostCells = std::size_t{1} << 20;

// Reads what `GET /v1/worlds/NAME/cells` answers. Pure and total. Errors: Malformed, TooLarge
// beyond kMostCells.
[[nodiscard]] Result<WorldCells> parse_cells(std::string_view answer);
// Of particles, which are no piece's.
inline constexpr char kParticleValue = 64;
// Cells with particles become free ones. Pure.
[[nodiscard]] WorldCells without_particles(WorldCells cells);
// The same bytes as parse_cells() reads, of all cells. Pure.
[[nodiscard]] std::string to_nrrd(const WorldCells& cells);
// The same as a NumPy array [x, y, z]. Pure.
[[nodiscard]] std::string to_npy(const WorldCells& cells);

}  // namespace thimble::cli
