#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace thimble::world {

// A .npy file as NumPy's specification says it, independent of our parser.
struct NpyBytes {
  std::string descr = "'|b1'";
  std::string fortran_order = "False";
  std::string shape = "(2, 3, 4)";
  std::string data = std::string(24, '\0');
  int version = 1;

  [[nodiscard]] std::string text() const {
    return "{'descr': " + descr + ", 'fortran_order': " + fortran_order + ", 'shape': " + shape +
           ", }";
  }
  [[nodiscard]] std::string file() const { return file_with(text()); }
  [[nodiscard]] std::string file_with(std::string header) const {
    const std::size_t preamble = version == 1 ? 10 : 12;
    while ((preamble + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    std::string out = "\x93NUMPY";
    out += static_cast<char>(version);
    out += '\0';
    for (std::size_t i = 8; i < preamble; ++i) {
      out += static_cast<char>(header.size() >> (8 * (i - 8)));
    }
    return out + header + data;
  }
};

inline std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace thimble::world
