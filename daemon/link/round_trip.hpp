#pragma once

#include <cstdlib>

#include "hal/base/time.hpp"

namespace thimble::link {

// Smoothed round trip and its mean deviation, with the gains of RFC 6298 (1/8 and 1/4).
//
// Thread: one. RT: allocation-free. Errors: none; negative measurements count as zero.
class RoundTrip {
 public:
  void note(Duration measured) noexcept {
    if (measured < Duration::zero()) measured = Duration::zero();
    if (!is_known_) {
      is_known_ = true;
      smoothed_ = measured;
      deviation_ = measured / 2;
      return;
    }
    const Duration error = measured - smoothed_;
    deviation_ += (Duration(std::abs(error.count())) - deviation_) / 4;
    smoothed_ += error / 8;
  }
  void reset() noexcept { *this = {}; }

  [[nodiscard]] Duration smoothed() const noexcept { return smoothed_; }    // 0 until known
  [[nodiscard]] Duration deviation() const noexcept { return deviation_; }  // 0 until known

 private:
  bool is_known_{false};
  Duration smoothed_{};
  Duration deviation_{};
};

}  // namespace thimble::link
