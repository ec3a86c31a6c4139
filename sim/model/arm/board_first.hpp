#pragma once

#include <utility>

namespace thimble::sim {

// The board of a simulated arm as a base: bases are made in their order, so that ArmOnBoard behind
// it may be given a reference to a board that is there. A member would be made after all bases.
template <class Board>
class BoardFirst {
 protected:
  template <class Settings>
  explicit BoardFirst(const Settings& settings) : firmware_(settings) {}

  Board firmware_;
};

}  // namespace thimble::sim
