#include "drivers/falcon/firmware_image.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>

#include "drivers/falcon/falcon_wire.hpp"

namespace thimble::falcon {
namespace {

constexpr std::string_view kHowToGetIt =
    "; Novint's licence forbids to ship the Falcon's firmware: take nvent_firmware.bin from the "
    "folder 'firmware' of libnifalcon (https://github.com/libnifalcon/libnifalcon) or from "
    "Novint's "
    "SDK";

bool is_sha256(std::string_view text) {
  return text.size() == 2 * crypto_hash_sha256_BYTES &&
         text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

std::string in_small_letters(std::string text) {
  for (char& letter : text) {
    if (letter >= 'A' && letter <= 'F') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return text;
}

bool is_known(std::string_view sha256) {
  return std::any_of(wire::kKnownImages.begin(), wire::kKnownImages.end(),
                     [&](const wire::FirmwareImage& image) { return image.sha256 == sha256; });
}

// Closed at the end of its life.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)) {}
  ~OpenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

tl::unexpected<Error> fail_to_open(const std::string& path, int code) {
  if (code == ENOENT || code == ENOTDIR) {
    return fail(Errc::NotFound,
                "there is no firmware at '" + path + "'" + std::string(kHowToGetIt));
  }
  if (code == ENXIO) return fail(Errc::NotFound, "'" + path + "' is not a regular file");
  return fail(Errc::Permission, "'" + path + "' cannot be read by this process");
}

// A file only: a pipe would be waited for. What is opened is looked at, and not its name, at which
// something else may be in the meantime; open() itself waits for no pipe with O_NONBLOCK (open(2)).
Result<std::vector<std::uint8_t>> read_file(const std::string& path) {
  const OpenFile file(path);
  if (file.descriptor() < 0) return fail_to_open(path, errno);
  struct stat info {};
  if (::fstat(file.descriptor(), &info) != 0 || !S_ISREG(info.st_mode)) {
    return fail_to_open(path, ENXIO);
  }
  std::vector<std::uint8_t> bytes(kMaxImageBytes + 1);
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t got = ::read(file.descriptor(), bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(Errc::System, "reading '" + path + "' failed");
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  if (size > kMaxImageBytes) {
    return fail(Errc::TooLarge,
                "'" + path + "' is longer than 64 KiB and so no firmware of a Falcon");
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

std::string sha256_of(std::span<const std::uint8_t> bytes) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> sum{};
  crypto_hash_sha256(sum.data(), bytes.data(), bytes.size());
  std::string text;
  for (const unsigned char byte : sum) {
    text += "0123456789abcdef"[byte / 16];
    text += "0123456789abcdef"[byte % 16];
  }
  return text;
}

Result<std::vector<std::uint8_t>> load_image(const std::string& path, const std::string& sha256) {
  if (!sha256.empty() && !is_sha256(sha256)) {
    return fail(Errc::InvalidArgument, "firmware_sha256 is not 64 hexadecimal digits");
  }
  auto image = read_file(path);
  if (!image) return image;
  if (image->size() < wire::kImageBegin.size() ||
      !std::equal(wire::kImageBegin.begin(), wire::kImageBegin.end(), image->begin())) {
    return fail(Errc::Malformed, "'" + path + "' does not begin as a firmware of the Falcon does");
  }
  const std::string sum = sha256_of(*image);
  if (sha256.empty() && !is_known(sum)) {
    return fail(Errc::Malformed, "'" + path + "' is none of the known firmwares: its sha256 is " +
                                     sum + "; if it is meant, say so by firmware_sha256");
  }
  if (!sha256.empty() && sum != in_small_letters(sha256)) {
    return fail(Errc::Malformed,
                "'" + path + "' is not the firmware that was meant: its sha256 is " + sum);
  }
  return image;
}

}  // namespace thimble::falcon
