#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "sim/export/verb.hpp"

// What is taken is finite, and within what an arm could do; a refusal has its words.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::sim;
  const auto verb = parse_verb({reinterpret_cast<const char*>(data), size});
  if (!verb) {
    if (verb.error().message.empty()) std::abort();
    return 0;
  }
  for (const double number : verb->numbers) {
    if (!(std::abs(number) <= 1e6)) std::abort();
  }
  return 0;
}
