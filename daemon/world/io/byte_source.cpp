#include "daemon/world/io/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

namespace thimble::world {
namespace {

[[nodiscard]] tl::unexpected<Error> refused(const char* what) {
  const int code = errno;
  const std::string message = std::string(what) + ": " + std::strerror(code);
  if (code == ENOENT || code == ENOTDIR) return fail(Errc::NotFound, message);
  if (code == EACCES || code == EPERM) return fail(Errc::Permission, message);
  return fail(Errc::System, message);
}

[[nodiscard]] const char* kind_of(mode_t mode) noexcept {
  if (S_ISLNK(mode)) return "a symbolic link, which is not followed";
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

class FileSource final : public ByteSource {
 public:
  FileSource(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  ~FileSource() override { ::close(descriptor_); }

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }

  [[nodiscard]] Result<std::size_t> read(std::span<std::byte> out) override {
    std::size_t done = 0;
    while (done < out.size()) {
      const ssize_t count = ::read(descriptor_, out.data() + done, out.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return refused("read");
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return done;
  }

 private:
  int descriptor_;
  std::uint64_t size_;
};

using SourceResult = Result<std::unique_ptr<ByteSource>>;

// `flags`: 0, or AT_SYMLINK_NOFOLLOW.
[[nodiscard]] SourceResult open_at(int folder, const std::string& name, int flags) {
  struct stat status {};
  // Asked first, because opening a device may already do something; asked again of what was
  // opened, because the name may mean something else by then.
  if (::fstatat(folder, name.c_str(), &status, flags) != 0) return refused("open");
  if (!S_ISREG(status.st_mode)) {
    return fail(Errc::InvalidArgument,
                std::string("is ") + kind_of(status.st_mode) + ", expected a regular file");
  }
  const int links = flags == 0 ? 0 : O_NOFOLLOW;
  const int descriptor =
      ::openat(folder, name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | links);
  if (descriptor < 0) return refused("open");
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return fail(Errc::InvalidArgument, "is no longer a regular file");
  }
  return std::make_unique<FileSource>(descriptor, static_cast<std::uint64_t>(status.st_size));
}

class Descriptor {
 public:
  explicit Descriptor(int value) noexcept : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { reset(-1); }
  void reset(int value) noexcept {
    if (value_ >= 0) ::close(value_);
    value_ = value;
  }
  [[nodiscard]] int get() const noexcept { return value_; }

 private:
  int value_;
};

// Goes on into the folder `part` of `folder`.
[[nodiscard]] Result<void> enter(Descriptor& folder, const std::string& part) {
  if (part == "..") return fail(Errc::InvalidArgument, "its folder .. is above its header's");
  struct stat status {};
  if (::fstatat(folder.get(), part.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) {
    return refused("open");
  }
  if (S_ISLNK(status.st_mode)) {
    return fail(Errc::InvalidArgument, "its folder " + part + " is " + kind_of(status.st_mode));
  }
  folder.reset(::openat(folder.get(), part.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (folder.get() < 0) return refused("open");
  return {};
}

}  // namespace

Result<std::size_t> MemorySource::read(std::span<std::byte> out) {
  const std::size_t count = std::min(out.size(), rest_.size());
  std::copy_n(rest_.begin(), count, out.begin());
  rest_ = rest_.subspan(count);
  return count;
}

Result<std::unique_ptr<ByteSource>> open_file(const std::string& path) {
  return open_at(AT_FDCWD, path, 0);
}

Result<std::unique_ptr<ByteSource>> open_file_below(const std::string& folder,
                                                    const std::string& name) {
  Descriptor at(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (at.get() < 0) return refused("open");
  std::string_view rest = name;
  for (auto end = rest.find('/'); end != std::string_view::npos; end = rest.find('/')) {
    const std::string part(end == 0 ? "." : rest.substr(0, end));
    if (auto entered = enter(at, part); !entered) return tl::unexpected(entered.error());
    rest.remove_prefix(end + 1);
  }
  return open_at(at.get(), std::string(rest), AT_SYMLINK_NOFOLLOW);
}

}  // namespace thimble::world
