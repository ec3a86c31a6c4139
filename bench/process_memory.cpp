#include "bench/process_memory.hpp"

#include <cstdlib>
#include <fstream>

namespace thimble::bench {

std::optional<double> process_bytes(const std::string& process, std::string_view line) {
  std::ifstream status("/proc/" + process + "/status");
  for (std::string text; std::getline(status, text);) {
    if (text.compare(0, line.size(), line) != 0 || text[line.size()] != ':') continue;
    return 1024 * std::strtod(text.c_str() + line.size() + 1, nullptr);  // proc(5): in kB
  }
  return std::nullopt;
}

}  // namespace thimble::bench
