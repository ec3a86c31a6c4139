#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "sim/export/uhid_wire.hpp"

// What is taken points into what came.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::sim::uhid;
  const auto event = parse({data, size});
  if (!event) return 0;
  std::span<const std::uint8_t> bytes;
  if (const auto* output = std::get_if<Output>(&*event)) bytes = output->bytes;
  if (const auto* set = std::get_if<SetReport>(&*event)) bytes = set->bytes;
  if (bytes.size() > kMaxReportBytes) std::abort();
  if (!bytes.empty() && (bytes.data() < data || bytes.data() + bytes.size() > data + size)) {
    std::abort();
  }
  return 0;
}
