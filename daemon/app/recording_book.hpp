#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "hal/device/fault.hpp"

namespace thimble::app {

// What became of the recordings of the latest stops. A slow disk may finish the one of an earlier
// stop when a later one of the same code is shown already, so a stop is known by its number and its
// tick, not by its code. The number alone would not do: an arm that is lost while it rests latches
// nothing, and all such stops have number 0.
//
// Thread: one. Not RT.
class RecordingBook {
 public:
  // Of each arm. A tick stops an arm at most three times, and one stop at a time is shown.
  static constexpr std::size_t kKept = 8;

  // `what` is the recording's path, or why it could not be written.
  void note(const std::string& arm, const Fault& stop, std::string what);
  // Empty while that stop's recording is not written, and long after.
  [[nodiscard]] std::string find(const std::string& arm, const Fault& stop) const;

 private:
  struct Entry {
    Fault stop;
    std::string what;
  };
  std::map<std::string, std::vector<Entry>> entries_;  // by arm, oldest first
};

}  // namespace thimble::app
