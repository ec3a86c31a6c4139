#include "hal/linux/replace_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

namespace thimble::linux {
namespace {

constexpr mode_t kNewMode = 0666;  // less the umask
constexpr int kMaxTries = 100;     // names that processes of this number left when they died

// Takes the descriptor. 0, or the errno.
int write_and_close(int descriptor, std::string_view text) noexcept {
  const int error = write_all(descriptor, text);
  if (::close(descriptor) != 0 && error == 0) return errno;
  return error;
}

int write_in_place(const std::string& path, std::string_view text) noexcept {
  const int descriptor =
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOCTTY | O_CLOEXEC, kNewMode);
  return descriptor < 0 ? errno : write_and_close(descriptor, text);
}

// Where the links of `path` lead to: the file that is replaced, or made.
// Nothing: it is to be written where it is.
struct Target {
  std::string path;
  std::optional<mode_t> mode;  // of the one that is there
};
std::optional<Target> target_of(const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) {
    if (errno != ENOENT) return std::nullopt;
    return Target{path, std::nullopt};
  }
  std::error_code error;
  const std::string real = std::filesystem::canonical(path, error);
  if (error || ::stat(real.c_str(), &found) != 0) return std::nullopt;
  const bool is_ours = S_ISREG(found.st_mode) && found.st_nlink == 1 && found.st_uid == ::geteuid();
  if (!is_ours) return std::nullopt;
  return Target{real, found.st_mode & 07777U};
}

// A file that nobody else has, in the folder of `path`.
struct Part {
  std::string path;
  int descriptor{-1};
  int error{0};  // why there is none
};
Part make_part(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (int number = 0; number < kMaxTries; ++number) {
    // Not made of the name: that may be as long as a name may be.
    const std::string name =
        ".thimble-" + std::to_string(::getpid()) + "-" + std::to_string(number) + ".part";
    Part part{folder / name};
    part.descriptor = ::open(part.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kNewMode);
    if (part.descriptor >= 0) return part;
    part.error = errno;
    if (part.error != EEXIST) return part;
  }
  return {{}, -1, EEXIST};
}

// Nobody may put a file there; on a full disk, or without descriptors, to write in place would only
// take away what is there.
bool is_about_rights(int error) noexcept {
  return error == EACCES || error == EPERM || error == EROFS;
}

// 0, or the errno. Nothing of the part is left where it did not become the target.
int write_beside(const Target& target, const Part& part, std::string_view text) noexcept {
  int error = 0;
  if (target.mode && ::fchmod(part.descriptor, *target.mode) != 0) error = errno;
  const int written = write_and_close(part.descriptor, error == 0 ? text : std::string_view{});
  if (error == 0) error = written;
  if (error == 0 && ::rename(part.path.c_str(), target.path.c_str()) != 0) error = errno;
  if (error != 0) ::unlink(part.path.c_str());
  return error;
}

int replace(const std::string& path, std::string_view text) {
  const std::optional<Target> target = target_of(path);
  if (!target) return write_in_place(path, text);
  // What may not be written is not replaced either, though its folder would let us.
  if (target->mode && ::access(target->path.c_str(), W_OK) != 0) return errno;
  const Part part = make_part(target->path);
  if (is_about_rights(part.error)) return write_in_place(target->path, text);
  if (part.error != 0) return part.error;
  return write_beside(*target, part, text);
}

}  // namespace

int write_all(int descriptor, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    if (count == 0) return EIO;  // no file gives it; nothing else would end this loop
    if (count < 0 && errno != EINTR) return errno;
  }
  return 0;
}

Result<void> replace_file(const std::string& path, std::string_view text) {
  const int error = replace(path, text);
  if (error == 0) return {};
  return fail(Errc::System, std::strerror(error));
}

}  // namespace thimble::linux
