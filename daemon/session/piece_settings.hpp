#pragma once

#include <memory>

#include "daemon/config/config.hpp"
#include "daemon/session/board_search.hpp"
#include "daemon/session/made_world.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::session {

// The world of pieces that a configuration describes, on a simulated CAM board of its own, which
// scans in the thread that touches the world and takes no longer than that; or on one that is
// plugged in at `plugs`, which is looked for once the world runs. Any thread; not RT. `clock` must
// outlive it. Errors: Unsupported without a clock, or without the plugs that it needs;
// InvalidArgument for more pieces than there is room for, or a layout that is none; and what
// reading its file says.
[[nodiscard]] Result<MadeWorld> make_piece_world(const config::WorldConfig& said,
                                                 const Clock* clock, const BoardPlugs& plugs = {});

}  // namespace thimble::session
