#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "daemon/link/link_key.hpp"

namespace thimble::link {
namespace {

// The longest key, its end of line, and one more to see that a file is longer.
constexpr std::size_t kMaxFileBytes = 2 * LinkKey::kSize + 3;

class Descriptor {
 public:
  // A pipe would be waited for: open(2), O_NONBLOCK.
  explicit Descriptor(const std::string& path)
      : number_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

tl::unexpected<Error> fail_to_open(const std::string& path, int code) {
  if (code == ENOENT || code == ENOTDIR) {
    return fail(Errc::NotFound, "there is no key file '" + path + "'");
  }
  if (code == EACCES || code == EPERM) {
    return fail(Errc::Permission, "key file '" + path + "' cannot be read by this process");
  }
  return fail(Errc::System, "key file '" + path + "': " + std::strerror(code));
}

// What was opened is looked at, not its name, at which something else may be meanwhile.
Result<void> check_owner(const std::string& path, int descriptor) {
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return fail_to_open(path, errno);
  if (!S_ISREG(info.st_mode)) {
    return fail(Errc::InvalidArgument, "key file '" + path + "' is not a regular file");
  }
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) == 0) return {};
  return fail(Errc::Permission,
              "key file '" + path + "' is open to others than its owner; chmod 600 '" + path + "'");
}

}  // namespace

Result<LinkKey> load_key(const std::string& path) {
  const Descriptor file(path);
  if (file.number() < 0) return fail_to_open(path, errno);
  if (const Result<void> good = check_owner(path, file.number()); !good) {
    return tl::unexpected(good.error());
  }
  std::array<std::byte, kMaxFileBytes> bytes{};
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t got = ::read(file.number(), bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail_to_open(path, errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  Result<LinkKey> key = parse_key(std::span(bytes).first(size));
  sodium_memzero(bytes.data(), bytes.size());
  if (!key) return tl::unexpected(key.error().in("key file '" + path + "'"));
  return key;
}

}  // namespace thimble::link
