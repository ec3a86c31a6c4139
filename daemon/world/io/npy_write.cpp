#include "daemon/world/io/npy_write.hpp"

namespace thimble::world {

std::string npy_head(std::string_view descr, const std::array<std::uint32_t, 3>& sizes) {
  constexpr std::size_t kAlignment = 64;  // of what is behind the header (NumPy's own)
  std::string head = "{'descr': '" + std::string(descr) + "', 'fortran_order': True, 'shape': (";
  for (const std::uint32_t size : sizes) head += std::to_string(size) + ", ";
  head += "), }";
  std::string file("\x93NUMPY\x01\x00", 8);
  while ((file.size() + 2 + head.size() + 1) % kAlignment != 0) head += ' ';
  head += '\n';
  file += static_cast<char>(head.size() & 0xff);
  file += static_cast<char>(head.size() >> 8);
  return file += head;
}

}  // namespace thimble::world
