#pragma once

#include <filesystem>

#include "cli/doctor/daemon_socket.hpp"
#include "cli/doctor/facts.hpp"
#include "hal/plugin/driver_registry.hpp"

namespace thimble::doctor {

// Reads the machine whose /proc, /sys, /dev and /etc are below `root`; "/" is this one. Opens no
// device but, where `config` has [safety], GPIO chips, and changes nothing. What cannot be read
// stays empty. What an arm is, the drivers' passive probes say, as they would to the daemon.
// `daemon` is what who_listens() said.
// Thread: any. Not RT.
[[nodiscard]] Facts read_facts(const std::filesystem::path& root,
                               const plugin::DriverRegistry& drivers,
                               const DaemonAtSocket& daemon = {},
                               const config::Config& config = {});

}  // namespace thimble::doctor
