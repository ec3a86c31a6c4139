#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "daemon/world/cell.hpp"
#include "daemon/world/occupancy_block.hpp"
#include "daemon/world/voxel_grid.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::world {

// Tells one peer, answer by answer, of the blocks of a grid that he does not know yet, or not as
// they are now: those never told first, the nearest of them before the others, then those that were
// told the longest ago. What a peer has is what he says that he applied; until then he is told
// again, so that what was lost or overtaken is missed for the shortest time.
//
// Changes are found by looking, while the grid changes: at the blocks around the ghost in each
// answer, at a few of the others in turn.
//
// Thread: the world's. Not RT: neither blocks nor, after reset(), allocates; a look at 35 blocks an
// answer, and nothing at all once the peer knows a grid that stays. What each answer asks of every
// block stands by itself in 4 KiB, of which a processor keeps many sessions'. Ownership: none; the
// grid is given to each call. Errors: none; answers that were never given are not acknowledged.
class OccupancyTeller {
 public:
  // Of 32 bits all but what one answer may take, and many times that.
  static constexpr std::uint32_t kMostVersions = 0xfff0'0000;

  // `most_versions`: after which is_used_up(). At 1000 changed blocks a second that is 50 days.
  explicit OccupancyTeller(std::uint32_t most_versions = kMostVersions) noexcept
      : most_versions_(most_versions) {}

  // A new session: the peer knows nothing. Allocates once.
  void reset();
  // All cells were replaced at once: what the peer knows is void. Versions go on, for one who does
  // not hear that it is, unless they are used up. After reset() only; allocates nothing.
  void forget() noexcept;
  // A version of a block is soon none that is newer than all before: tell the peer that what he
  // knows is void, and forget().
  [[nodiscard]] bool is_used_up() const noexcept { return versions_ >= most_versions_; }
  // He has applied answer `newest`, and of those before it `newest − 1 − i` where bit i of `before`
  // is set.
  void acknowledge(std::uint64_t newest, std::uint64_t before) noexcept;
  // What goes with answer `number`, which is above all before; the ghost is in `ghost`.
  [[nodiscard]] ToldBlocks tell(const VoxelGrid& grid, Cell ghost, std::uint64_t number) noexcept;

  // Blocks of the window that the peer is not known to have.
  [[nodiscard]] std::size_t open_blocks() const noexcept;

 private:
  using At = std::array<std::int16_t, 3>;
  struct Slot {
    // Otherwise it has another block's place: none was looked at since the window moved.
    [[nodiscard]] bool holds(const At& at) const noexcept {
      return block.version > 0 && block.at == at;
    }

    OccupancyBlock block{};          // as it is now; version 0: not in the window yet
    std::uint32_t known_version{0};  // what the peer has
    std::uint64_t told_in{0};        // the newest answer that has it as it is now; 0: none
    std::uint64_t seen_at{0};        // VoxelGrid::revision() of that look
  };
  struct Answer {
    std::uint64_t number{0};
    std::array<std::uint16_t, kMostBlocksTold> slots{};
    std::array<std::uint32_t, kMostBlocksTold> versions{};
    std::size_t count{0};
  };
  using Chosen = rt::StaticVector<std::size_t, kMostBlocksTold>;
  void center(const VoxelGrid& grid, const At& middle) noexcept;
  void look_at(const VoxelGrid& grid, std::size_t place) noexcept;
  void look_around(const VoxelGrid& grid) noexcept;
  void apply(std::uint64_t number) noexcept;
  void mark(std::size_t place) noexcept;
  [[nodiscard]] Chosen choose() const noexcept;

  std::vector<Slot> slots_{};
  // The blocks of the window, the nearest first.
  std::vector<At> window_{};
  std::vector<std::uint64_t> told_in_{};  // Slot's, of what the peer is to hear of; else kKnown
  std::vector<std::uint16_t> places_{};   // by slot: in the two above
  std::size_t near_{0};                   // of them: the first, which touch the middle
  std::vector<Answer> answers_{};
  std::uint64_t told_{0};  // the newest answer
  std::uint32_t versions_{0};
  std::uint32_t most_versions_;
  std::size_t turn_{0};  // of the looks at blocks far away
  // What was looked at without a break: as the grid is, around one place.
  std::uint64_t revision_{0};
  At middle_{};
  std::size_t looks_{0};
  bool is_quiet_{false};  // all has been looked at since, and the peer has it
};

}  // namespace thimble::world
