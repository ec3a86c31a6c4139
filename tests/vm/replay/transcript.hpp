#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace thimble::replay {

// What went over a bus between a driver and its device, as the driver's side of the bus had it.
struct Transcript {
  using Bytes = std::vector<std::uint8_t>;
  std::vector<Bytes> from_device;
  std::vector<Bytes> to_device;

  static Bytes copy(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }
};

[[nodiscard]] std::string hex(std::span<const std::uint8_t> bytes);

}  // namespace thimble::replay
