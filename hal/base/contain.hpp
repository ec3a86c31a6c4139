#pragma once

#include <exception>
#include <utility>

#include "hal/base/result.hpp"

namespace thimble {

// Does `work`, which may throw: an exception that left a thread would end the process, and with it
// the servo of every arm.
//
// Thread: any. Not RT. Errors: System, with the words of what was thrown.
template <class Work>
Result<void> contain(Work&& work) {
  try {
    std::forward<Work>(work)();
    return {};
  } catch (const std::exception& error) {
    return fail(Errc::System, error.what());
  } catch (...) {
    return fail(Errc::System, "an exception that says nothing of itself");
  }
}

}  // namespace thimble
