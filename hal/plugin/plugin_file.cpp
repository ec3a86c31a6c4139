#include "hal/plugin/plugin_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

namespace thimble::plugin {
namespace {

constexpr mode_t kOthersMayWrite = S_IWGRP | S_IWOTH;

struct FreeText {
  void operator()(char* text) const noexcept { std::free(text); }
};

tl::unexpected<Error> cannot_look() {
  const int error = errno;
  if (error == ENOENT) return fail(Errc::NotFound, "there is no such file");
  return fail(Errc::System, std::string("cannot be looked at: ") + std::strerror(error));
}

// `path` is what the caller puts in front.
Result<void> check_place(const std::string& place, const std::string& path) {
  struct stat found {};
  if (::lstat(place.c_str(), &found) != 0) return cannot_look();
  const std::string why = why_untrusted({found.st_mode, found.st_uid}, ::geteuid());
  if (!why.empty()) return fail(Errc::Permission, place == path ? why : place + " " + why);
  return {};
}

}  // namespace

std::string why_untrusted(const FileFacts& facts, uid_t user) {
  if (facts.owner != 0 && facts.owner != user) {
    return "belongs to user " + std::to_string(facts.owner) +
           ", who could change the code that the daemon runs; it must be root's or the daemon's";
  }
  const bool is_sticky_folder = S_ISDIR(facts.mode) && (facts.mode & S_ISVTX) != 0;
  if ((facts.mode & kOthersMayWrite) == 0 || is_sticky_folder) return "";
  return "may be written by its group or by others, who could change the code that the daemon "
         "runs; take that right away (chmod go-w)";
}

Result<std::string> trusted_plugin_path(const std::string& path) {
  if (!path.starts_with('/')) {
    return fail(Errc::InvalidArgument, "is not an absolute path, as a plugin's must be");
  }
  const std::unique_ptr<char, FreeText> real(::realpath(path.c_str(), nullptr));
  if (!real) return cannot_look();
  const std::string file = real.get();
  struct stat found {};
  if (::lstat(file.c_str(), &found) != 0) return cannot_look();
  if (!S_ISREG(found.st_mode)) return fail(Errc::InvalidArgument, "is not a regular file");
  for (std::string place = file; !place.empty(); place.erase(place.find_last_of('/'))) {
    const auto checked = check_place(place, path);
    if (!checked) return tl::unexpected(checked.error());
  }
  const auto root = check_place("/", path);
  if (!root) return tl::unexpected(root.error());
  return file;
}

Result<std::string> absolute_plugin_path(const std::string& said) {
  if (said.empty()) {
    return fail(Errc::InvalidArgument, "--plugin: the name of a file is expected, and it is empty");
  }
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(said, error);
  if (error) {
    return fail(Errc::System, "--plugin: the working folder, where " + said +
                                  " would be, cannot be had: " + error.message());
  }
  return path.string();
}

}  // namespace thimble::plugin
