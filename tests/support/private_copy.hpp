#pragma once

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace thimble::testing_support {

// A copy of a shared object that nobody else may write, as the loader wants it: a build tree may
// be writable by a group.
inline std::string private_copy(const TemporaryFolder& folder,
                                const std::filesystem::path& object) {
  namespace fs = std::filesystem;
  const fs::path copy = folder.path() / object.filename();
  fs::copy_file(object, copy, fs::copy_options::overwrite_existing);
  fs::permissions(copy, fs::perms::owner_read | fs::perms::owner_write);
  return copy.string();
}

}  // namespace thimble::testing_support
