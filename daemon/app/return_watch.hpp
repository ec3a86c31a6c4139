#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "hal/device/operating_state.hpp"

namespace thimble::app {

// Sees the arms go that were there, and those come back that were lost.
// Thread: one. Not RT.
class ReturnWatch {
 public:
  enum class Change { None, Left, Returned };
  // Since the arm was looked at last.
  [[nodiscard]] Change note(std::size_t arm, OperatingState state);
  // Another arm took the place, of which is told otherwise.
  void forget(std::size_t arm);

 private:
  enum class Seen { Never, There, Lost };
  std::vector<Seen> seen_;
};

// What a person is told of that arm. `change` is not None.
[[nodiscard]] std::string sentence_of(const config::ArmConfig& arm, ReturnWatch::Change change);

}  // namespace thimble::app
