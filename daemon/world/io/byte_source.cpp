#include "daemon/world/io/byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

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

}  // namespace

Result<std::size_t> MemorySource::read(std::span<std::byte> out) {
  const std::size_t count = std::min(out.size(), rest_.size());
  std::copy_n(rest_.begin(), count, out.begin());
  rest_ = rest_.subspan(count);
  return count;
}

Result<std::unique_ptr<ByteSource>> open_file(const std::string& path) {
  struct stat status {};
  // Asked first, because opening a device may already do something; asked again of what was
  // opened, because the name may mean something else by then.
  if (::stat(path.c_str(), &status) != 0) return refused("open");
  if (!S_ISREG(status.st_mode)) {
    return fail(Errc::InvalidArgument,
                std::string("is ") + kind_of(status.st_mode) + ", expected a regular file");
  }
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return refused("open");
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    return fail(Errc::InvalidArgument, "is no longer a regular file");
  }
  return std::make_unique<FileSource>(descriptor, static_cast<std::uint64_t>(status.st_size));
}

}  // namespace thimble::world
