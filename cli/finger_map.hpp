#pragma once

#include <string>
#include <vector>

#include "cli/text.hpp"
#include "daemon/api/status.hpp"

namespace thimble::cli {

// The finger in its world, seen along two axes: a picture of at most `room` lines and 80 columns,
// or nothing where that is too few to show anything. A box is drawn as it was made, a sphere with
// its floor as cut through the middle of the ball, a block where it is now; a last line says what
// of the world is not drawn. The hand (where the arm is) and the finger (where the hand is felt to
// be in the world: docs/api.md, .felt) are drawn apart when the offset or the delay shows. `world`
// may be null: then there are no walls.
[[nodiscard]] std::vector<std::string> finger_map(const api::ArmStatus& arm,
                                                  const api::WorldStatus* world, Glyphs glyphs,
                                                  std::size_t room);

}  // namespace thimble::cli
