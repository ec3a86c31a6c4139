#pragma once

#include <sys/types.h>

#include <string>

#include "hal/base/result.hpp"

namespace thimble::plugin {

// What decides whether others may put code into a file, or another file in its place.
struct FileFacts {
  mode_t mode{0};  // of stat()
  uid_t owner{0};
};

// Empty: only root or `user` may change it. A folder in which everybody may only remove what is
// theirs (sticky, such as /tmp) does no harm. Pure.
[[nodiscard]] std::string why_untrusted(const FileFacts& facts, uid_t user);

// The path of a plugin with every link followed, after a look at the file and at each folder above
// it: the code will run with the rights of this process, so only root or its own user may have put
// it there. Who could change a folder could put another file in the place after the look.
// Thread: control thread. Errors: InvalidArgument (a relative path, no regular file), NotFound,
// Permission, System; the message is the second half of a sentence about the file.
[[nodiscard]] Result<std::string> trusted_plugin_path(const std::string& path);

// What a person wrote behind `--plugin`, absolute: a relative path means the working folder.
// Thread: any. Errors: InvalidArgument where it is empty, System where that folder is not to be
// had; the message is a whole sentence.
[[nodiscard]] Result<std::string> absolute_plugin_path(const std::string& said);

}  // namespace thimble::plugin
