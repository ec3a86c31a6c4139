#pragma once

#include <filesystem>
#include <string_view>

#include "hal/base/result.hpp"
#include "hal/linux/descriptor.hpp"

namespace thimble::linux {

// A connection to one of the helpers that systemd starts as root: packets are kept apart
// (SOCK_SEQPACKET), and nothing waits for who accepts. `advice`: what to look at where it fails,
// "(systemctl status SOME.socket)".
// Thread: any; not RT. Errors: InvalidArgument, no name that a socket can have; NotFound, nobody
// made one there; Busy, too many wait for it already; Permission, System.
[[nodiscard]] Result<Descriptor> connect_to_helper(const std::filesystem::path& socket,
                                                   std::string_view advice);

}  // namespace thimble::linux
