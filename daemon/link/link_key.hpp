#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "hal/base/result.hpp"

namespace thimble::link {

// A secret that both ends of a link were given beforehand. Wiped at the end of its life.
// Thread: one at a time. Not RT.
class LinkKey {
 public:
  static constexpr std::size_t kSize = 32;

  explicit LinkKey(std::span<const std::byte, kSize> bytes) noexcept;
  ~LinkKey();
  LinkKey(const LinkKey&) = default;
  LinkKey& operator=(const LinkKey&) = default;

  [[nodiscard]] std::span<const std::byte, kSize> bytes() const noexcept { return bytes_; }
  bool operator==(const LinkKey& other) const noexcept;  // in constant time

 private:
  std::array<std::byte, kSize> bytes_{};
};

// What a key file may hold: 64 hexadecimal digits, with one end of line behind or none; or 32 bytes
// as they are. Total. Errors: Malformed, in one sentence that says how to make one.
[[nodiscard]] Result<LinkKey> parse_key(std::span<const std::byte> text);

// The key in the file at `path`. Control plane: reads a file.
// NotFound, Permission: there is none, or none that may be read, or the file's group or others may
// read or write it; Malformed as parse_key(); System.
[[nodiscard]] Result<LinkKey> load_key(const std::string& path);

}  // namespace thimble::link
