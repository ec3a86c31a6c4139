#pragma once

#include <cstddef>
#include <vector>

#include "hal/device/operating_state.hpp"

namespace thimble::app {

// Sees the arms come back that were lost.
// Thread: one. Not RT.
class ReturnWatch {
 public:
  // True: the arm was lost when it was looked at last, and is not any more.
  [[nodiscard]] bool note(std::size_t arm, OperatingState state);
  // Another arm took the place, of which is told otherwise.
  void forget(std::size_t arm);

 private:
  std::vector<bool> were_lost_;
};

}  // namespace thimble::app
