#pragma once

#include "daemon/config/config.hpp"
#include "daemon/world/io/volume_writer.hpp"

namespace thimble::session {

// What the configuration's words about a world mean to the readers of volumes. Pure.
[[nodiscard]] world::VolumeOptions volume_options(const config::WorldConfig& said);

}  // namespace thimble::session
