#pragma once

#include <array>
#include <cstddef>

#include "daemon/servo/entry_box.hpp"
#include "daemon/world/world.hpp"

namespace thimble::session {

// How many cells entry_into() looks at, at most. Ours: some milliseconds.
inline constexpr std::size_t kMostEntryLooks = std::size_t{1} << 20;

// Where an arm that stands at `place_m` of the world may begin to feel it: within the world, and
// within the layers of cells at its faces that are all matter, as in "box:3" all but the cell in
// the middle. As the cells are now: who opens a wall later begins inside all the same. A world that
// is matter everywhere has all of itself. Thread: that of the world. Not RT. Total.
[[nodiscard]] servo::EntryBox entry_into(const world::World& world,
                                         const std::array<double, 3>& place_m);

}  // namespace thimble::session
