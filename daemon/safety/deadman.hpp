#pragma once

#include "hal/base/time.hpp"

namespace thimble::safety {

// What a closed deadman counts for: it is held once it was seen let go of since the newest stop, or
// since its lines could be read (decision 0520). One that is taped closed or welded enables
// nothing.
//
// Thread: one. Pure.
class Deadman {
 public:
  // A bounce that one reading meets is no hand: ours.
  static constexpr int kOpenReadings = 2;

  // A stop, or nobody can read it: what was seen until now says nothing of what follows.
  void distrust() noexcept {
    is_trusted_ = false;
    open_readings_ = 0;
  }
  // A reading of its contact; one that was seen before counts once.
  void see(bool is_open, MonotonicTime read_at) noexcept {
    if (read_at <= newest_) return;
    newest_ = read_at;
    open_readings_ = is_open ? open_readings_ + 1 : 0;
    if (open_readings_ >= kOpenReadings) is_trusted_ = true;
  }
  [[nodiscard]] bool is_trusted() const noexcept { return is_trusted_; }

 private:
  MonotonicTime newest_{};
  int open_readings_{0};  // in a row
  bool is_trusted_{false};
};

}  // namespace thimble::safety
