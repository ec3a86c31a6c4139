#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/load.hpp"
#include "daemon/session/arm_rig.hpp"
#include "daemon/session/plugins.hpp"

namespace thimble::session {

// What Runtime::create() would stumble over, all of it at once and by its keys: devices that this
// build cannot reach, models, limits, persons and volumes that cannot be. Opens no device and no
// socket, loads no volume (of a file it reads the header): numbers within a file, taken ports and
// missing rights are found only at the start.
// Thread: control thread. Not RT.
// Not `is_whole`: a plugin was refused, so that a name which nobody here has may be its.
[[nodiscard]] std::vector<config::Objection> inspect(const config::Config& config,
                                                     const RigParts& parts, bool is_whole = true);

// What is wrong with the files that real arms need. They can be mended while the daemon runs, and
// the other arms need them not, so a start looks at none: decision 0330.
[[nodiscard]] std::vector<config::Objection> inspect_files(const config::Config& config,
                                                           const plugin::DriverRegistry& drivers);

inline constexpr std::string_view kFalconWantsFirmware =
    "arm.firmware: a Falcon forgets its own with its power, and has no force without; "
    "docs/first-arm.md "
    "says where to get the file";
inline constexpr std::string_view kFalconKeepsForce =
    "may go on pushing until its own supply is switched off, if its USB plug is pulled while it "
    "pushes; keep a hand on that switch, or build the circuit of docs/safety-wiring.md and set "
    "safety.enable";
// What is no mistake, but will most likely be missed, with the arm's name in front: the firmware of
// a Falcon that nobody else loads, the samples of one that a slow servo leaves out, neither where a
// plugin drives Falcons; and the force of one that nothing could end, whoever drives it. Where a
// plugin does not tell what it drives, only the last, of an arm that the configuration calls one.
[[nodiscard]] std::vector<std::string> doubts_of(const config::Config& config,
                                                 const plugin::DriverRegistry& drivers);

// The same as inspect() with the plugins that the configuration names, which are loaded into
// `plugins` first.
[[nodiscard]] std::vector<config::Objection> inspect_with_plugins(const config::Config& config,
                                                                  Plugins& plugins);

}  // namespace thimble::session
