#include "bench/reference_read_file.hpp"

#include <cstdio>
#include <vector>

std::size_t reference_read_file(const std::string& path) {
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return 0;
  std::setvbuf(file, nullptr, _IONBF, 0);
  std::vector<char> chunk(65536);
  std::size_t total = 0;
  for (std::size_t count = 1; count > 0; total += count) {
    count = std::fread(chunk.data(), 1, chunk.size(), file);
  }
  std::fclose(file);
  return total;
}
