#pragma once

#include <exception>
#include <type_traits>
#include <utility>

#include "hal/base/result.hpp"

namespace thimble {

// What contain() makes of what a work returns: a Result stays the Result that it is.
template <class T>
struct Contained {
  using Type = Result<T>;
};
template <class T>
struct Contained<Result<T>> {
  using Type = Result<T>;
};

// Does `work`, which may throw, and gives what it gives: an exception that left a thread would end
// the process, and with it the servo of every arm.
//
// Thread: any. Not RT. Errors: those of `work`; System, with the words of what was thrown.
template <class Work>
typename Contained<std::invoke_result_t<Work&>>::Type contain(Work&& work) {
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<Work&>>) {
      work();
      return {};
    } else {
      return work();
    }
  } catch (const std::exception& error) {
    return fail(Errc::System, error.what());
  } catch (...) {
    return fail(Errc::System, "an exception that says nothing of itself");
  }
}

}  // namespace thimble
