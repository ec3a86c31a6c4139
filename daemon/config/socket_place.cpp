#include "daemon/config/socket_place.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace thimble::config {
namespace {

namespace fs = std::filesystem;

// Of what lies in a folder that everybody may write. A link is judged by who made it.
Result<void> check_owner(const fs::path& path, bool is_sticky) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) {
    if (errno == ENOENT) return fail(Errc::NotFound, path.string() + " is not there");
    return {};
  }
  if (is_sticky && (info.st_uid == 0 || info.st_uid == ::geteuid())) return {};
  return fail(Errc::Permission, path.string() +
                                    " belongs to another user, or to whoever replaces it, as "
                                    "anybody may do there; --socket names another socket");
}

}  // namespace

Result<void> check_socket_place(const std::string& socket_path) {
  std::error_code error;
  fs::path path = fs::absolute(socket_path, error);  // ".." as the kernel takes it
  for (; !error && path.has_relative_path(); path = path.parent_path()) {
    struct stat folder {};
    if (::stat(path.parent_path().c_str(), &folder) != 0) continue;
    if ((folder.st_mode & S_IWOTH) == 0) continue;
    auto done = check_owner(path, (folder.st_mode & S_ISVTX) != 0);
    if (!done) return done;
  }
  return {};
}

}  // namespace thimble::config
