#pragma once

#include <string>

#include "hal/base/result.hpp"

namespace thimble::plugin {

// Whether a shared object of this machine has all the bytes that its head promises. The dynamic
// linker does not look: a file that is cut short, as by a copy that is still under way, ends the
// process with SIGBUS. What is no such object is the linker's to refuse, and no error here.
// Thread: control thread. Errors: Malformed (cut short), System (cannot be read); the message is
// the second half of a sentence about the file.
[[nodiscard]] Result<void> check_object_is_whole(const std::string& path);

}  // namespace thimble::plugin
