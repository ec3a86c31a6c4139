#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/result.hpp"

namespace thimble::sim::cam {

// A space of sites of 16 bits on a torus, without the board: what a scan of a whole CAM does to it,
// in docs/cambus.md's words. Bit n of a site is that of layer n; a site's index is
// x + X (y + Y z).
struct SiteSpace {
  std::array<int, 3> log2_cells{0, 0, 0};  // along x, y, z

  [[nodiscard]] constexpr int log2_sites() const noexcept {
    return log2_cells[0] + log2_cells[1] + log2_cells[2];
  }
  [[nodiscard]] constexpr std::size_t sites() const noexcept {
    return std::size_t{1} << log2_sites();
  }
  bool operator==(const SiteSpace&) const = default;
};
// Ours: a word of each plane at least, and what the largest board has (64 modules of 2^24 sites).
inline constexpr int kMinLog2SpaceSites = 6;
inline constexpr int kMaxLog2SpaceSites = 30;
// Errors: InvalidArgument.
[[nodiscard]] Result<void> check_space(const SiteSpace& space);

// As the driver has them (drivers/cambus/cam_space.hpp).
using LayerBits = std::uint16_t;
struct PlaneKick {
  LayerBits layers{0};
  std::array<int, 3> cells{0, 0, 0};  // +1 moves what is in these layers by one cell; any number
};

// What is counted in a step, of each layer: nothing, its bit before the table, or behind it.
enum class Counting : std::uint8_t { Nothing, Sites, Outputs };

struct StepOptions {
  std::size_t bank{0};        // the table in force
  LayerBits fixed{0};         // the table is told `fixed_bits` of these layers instead
  LayerBits fixed_bits{0};    //
  LayerBits written{0xffff};  // the other layers keep their bits
  Counting counting{Counting::Nothing};
};

using PlaneCounts = std::array<std::uint64_t, 16>;  // by layer

// Updates such a space. A step first kicks the layers that are named (the last of several kicks of
// a layer counts), then every site goes through the table at once.
//
// Thread: one at a time. Not RT. Ownership: its own.
class Engine {
 public:
  static constexpr std::size_t kBanks = 2;

  virtual ~Engine() = default;
  [[nodiscard]] virtual const SiteSpace& space() const noexcept = 0;
  // All sites. Errors: InvalidArgument when there are not as many as the space has.
  virtual Result<void> put(std::span<const std::uint16_t> sites) = 0;
  virtual Result<void> get(std::span<std::uint16_t> sites) = 0;
  // A table of 65,536 entries into a bank; no table is one that leaves sites as they are.
  // Errors: InvalidArgument for another length or bank, and what the kind of engine says.
  virtual Result<void> load(std::size_t bank, std::span<const std::uint16_t> table) = 0;
  // Errors: InvalidArgument for a bank that is not there.
  virtual Result<PlaneCounts> step(std::span<const PlaneKick> kicks,
                                   const StepOptions& options) = 0;
  // How many sites have each layer's bit.
  [[nodiscard]] virtual PlaneCounts population() = 0;
};

}  // namespace thimble::sim::cam
