#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/model/cam/sync_pulses.hpp"

namespace thimble::sim::cam {

// A monitor on the raw video port: sixteen signals, one from each layer, of one module. Keeps the
// frame that is being drawn, or that was drawn last; where nothing was shown it is black.
// A pixel is a site, in the order of the sweep that began with its line; what a palette makes of
// them is not modelled. Thread: one at a time.
class VideoMonitor {
 public:
  // Ours: enough for any monitor of its day; what is beyond is dropped.
  static constexpr std::size_t kMostLines = 1024;
  static constexpr std::size_t kMostPixels = 4096;

  void draw(const SyncPulses::Place& place, std::span<const std::uint16_t> pixels);

  // How many frames have been drawn on.
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
  // From the left; empty: black. Until something is drawn.
  [[nodiscard]] std::span<const std::uint16_t> line(std::size_t number) const noexcept {
    if (number >= lines_.size()) return {};
    return lines_[number];
  }

 private:
  std::uint64_t frames_{0};
  std::uint64_t frame_{0};
  std::vector<std::vector<std::uint16_t>> lines_{};
};

}  // namespace thimble::sim::cam
