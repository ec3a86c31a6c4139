#include "daemon/link/link_key.hpp"

#include <sodium.h>

#include <algorithm>

namespace thimble::link {
namespace {

// -1: no digit.
int digit_of(std::byte letter) noexcept {
  const auto c = std::to_integer<int>(letter);
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::span<const std::byte> without_end_of_line(std::span<const std::byte> text) noexcept {
  if (!text.empty() && text.back() == std::byte{'\n'}) text = text.first(text.size() - 1);
  if (!text.empty() && text.back() == std::byte{'\r'}) text = text.first(text.size() - 1);
  return text;
}

}  // namespace

LinkKey::LinkKey(std::span<const std::byte, kSize> bytes) noexcept {
  std::copy(bytes.begin(), bytes.end(), bytes_.begin());
}

LinkKey::~LinkKey() { sodium_memzero(bytes_.data(), bytes_.size()); }

bool LinkKey::operator==(const LinkKey& other) const noexcept {
  return sodium_memcmp(bytes_.data(), other.bytes_.data(), kSize) == 0;
}

Result<LinkKey> parse_key(std::span<const std::byte> text) {
  if (text.size() == LinkKey::kSize) return LinkKey(text.first<LinkKey::kSize>());
  const auto digits = without_end_of_line(text);
  std::array<std::byte, LinkKey::kSize> bytes{};
  bool is_key = digits.size() == 2 * LinkKey::kSize;
  for (std::size_t i = 0; is_key && i < LinkKey::kSize; ++i) {
    const int high = digit_of(digits[2 * i]);
    const int low = digit_of(digits[2 * i + 1]);
    is_key = high >= 0 && low >= 0;
    if (is_key) bytes[i] = static_cast<std::byte>(16 * high + low);
  }
  if (!is_key) {
    return fail(Errc::Malformed,
                "it holds no key: a key is 64 hexadecimal digits, such as openssl rand -hex 32 "
                "makes, or 32 bytes");
  }
  LinkKey key(bytes);
  sodium_memzero(bytes.data(), bytes.size());
  return key;
}

}  // namespace thimble::link
