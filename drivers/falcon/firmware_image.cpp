#include "drivers/falcon/firmware_image.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

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

// A file only: a pipe would be waited for.
Result<std::vector<std::uint8_t>> read_file(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return fail(Errc::NotFound,
                "there is no firmware at '" + path + "'" + std::string(kHowToGetIt));
  }
  if (!std::filesystem::is_regular_file(status)) {
    return fail(Errc::InvalidArgument, "'" + path + "' is not a regular file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(Errc::Permission, "'" + path + "' cannot be read by this process");
  std::vector<std::uint8_t> bytes(kMaxImageBytes + 1);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (file.bad()) return fail(Errc::System, "reading '" + path + "' failed");
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  if (bytes.size() > kMaxImageBytes) {
    return fail(Errc::TooLarge,
                "'" + path + "' is longer than 64 KiB and so no firmware of a Falcon");
  }
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
