#pragma once

#include "daemon/config/config.hpp"

namespace thimble::config {

// Whether arms with these schemes may be each other's far end (daemon/coupling/arm_pair.hpp); Auto
// means GhostPoint.
[[nodiscard]] bool are_peers(CouplingScheme one, CouplingScheme other);

}  // namespace thimble::config
