#include "sim/model/cam/video_monitor.hpp"

#include <algorithm>

namespace thimble::sim::cam {

void VideoMonitor::draw(const SyncPulses::Place& place, std::span<const std::uint16_t> pixels) {
  if (frames_ == 0 || place.frame != frame_) {
    ++frames_;
    frame_ = place.frame;
    lines_.clear();
  }
  if (place.line >= kMostLines) return;
  if (lines_.size() <= place.line) lines_.resize(place.line + 1);
  const auto seen = pixels.first(std::min(pixels.size(), kMostPixels));
  lines_[place.line].assign(seen.begin(), seen.end());
}

}  // namespace thimble::sim::cam
