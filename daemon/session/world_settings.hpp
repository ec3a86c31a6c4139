#pragma once

#include <memory>

#include "daemon/config/config.hpp"
#include "daemon/session/board_search.hpp"
#include "daemon/session/made_world.hpp"
#include "daemon/world/io/field_file.hpp"
#include "daemon/world/io/mesh_file.hpp"
#include "daemon/world/io/volume_writer.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::session {

// What the configuration's words about a world mean to the readers of volumes. Any thread; pure.
[[nodiscard]] world::VolumeOptions volume_options(const config::WorldConfig& said);

// The same of one with a [world.field].
[[nodiscard]] world::FieldOptions field_options(const config::WorldConfig& said);
// The same of a mesh.
[[nodiscard]] world::MeshFieldOptions mesh_options(const config::WorldConfig& said);

// Whether it lives on a real board.
[[nodiscard]] bool is_board_plugged_in(const config::WorldConfig& said) noexcept;

// The world that a configuration describes. Any thread; not RT: reads the file where there is one.
// `clock`, for worlds that take their time, must outlive it; nullptr where there is none. `plugs`:
// of worlds on a board that is plugged in. Errors: one sentence that starts with the source.
[[nodiscard]] Result<MadeWorld> make_world(const config::WorldConfig& said, const Clock* clock,
                                           const BoardPlugs& plugs = {});

}  // namespace thimble::session
