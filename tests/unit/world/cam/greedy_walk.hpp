#pragma once

#include <cstddef>

#include "hal/device/cam_board.hpp"

namespace thimble::world::cam::test {

// How far a shape comes of `desired`: along each axis as far as it is free, one cell after the
// other, while that helps. What a search is measured by. `overlaps` is asked of one displacement.
template <class Overlaps>
CamAxes greedy_walk(const CamAxes& desired, const Overlaps& overlaps) {
  CamAxes at{};
  for (bool helped = true; helped;) {
    helped = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      while (at[axis] != desired[axis]) {
        CamAxes next = at;
        next[axis] += desired[axis] < at[axis] ? -1 : 1;
        if (overlaps(next)) break;
        at = next;
        helped = true;
      }
    }
  }
  return at;
}

}  // namespace thimble::world::cam::test
