#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "hal/base/result.hpp"

namespace thimble::world {

// What a file says of its volume.
struct VolumeShape {
  std::array<std::uint32_t, 3> sizes{};
  std::array<double, 3> spacing{1, 1, 1};       // in any one unit: only the ratios count
  std::array<std::size_t, 3> fastest{0, 1, 2};  // the axis that runs fastest, first
};

// Takes the numbers of a volume as they come from a file.
//
// Thread: one. Not RT. Errors: its own; the numbers that follow are then of no use.
class NumberSink {
 public:
  // How many are still to come.
  [[nodiscard]] virtual std::uint64_t items_left() const noexcept = 0;
  // The next numbers of the file; not more than are left.
  [[nodiscard]] virtual Result<void> put(std::span<const double> values) = 0;

 protected:
  ~NumberSink() = default;
};

// Asked once, when the shape is known and before a number is read; what it gives outlives the call.
using SinkMaker = std::function<Result<NumberSink*>(const VolumeShape&)>;

}  // namespace thimble::world
