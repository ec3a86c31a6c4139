#pragma once

#include <string>
#include <vector>

#include "cli/devices/inventory.hpp"
#include "daemon/api/status.hpp"

namespace thimble::devices_list {

// What a configuration lacks of those `entries` that are plugged in arms and that nobody uses: a
// table `[[arm]]` for each, as in docs/first-arm.md, in TOML, to be put behind what is there. None
// activates its arm or asks for more force than a first touch's. What only a person knows, which
// arm a controller drives, is left to them, as lines in which the `#` is to be taken away: without
// it `thimbled --check` says what is missing. Names are those that no arm of `status` has, the
// world is its first one, "box" where it has none. `daemon` is a sentence about the daemon.
[[nodiscard]] std::string arm_tables(const std::vector<Entry>& entries, const api::Status& status,
                                     const std::string& daemon);

}  // namespace thimble::devices_list
