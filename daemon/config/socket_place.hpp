#pragma once

#include <string>

#include "hal/base/result.hpp"

namespace thimble::config {

// Whether nobody but root, the caller and those whom they let have the place can have put the
// socket there. Where anybody may make things, as in /tmp, what lies there, be it the socket or a
// folder on the way to it, has to be root's or the caller's own.
//
// Thread: any. Not RT. What is the caller's own in a sticky folder nobody else replaces later
// (inode(7)); of a folder without that bit nothing holds, and so it is refused.
// Errors: Permission for a place that is a stranger's, by one sentence; NotFound where nothing is
//         yet. What cannot be seen is well: nobody connects to it either.
[[nodiscard]] Result<void> check_socket_place(const std::string& socket_path);

}  // namespace thimble::config
