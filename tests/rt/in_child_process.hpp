#pragma once

#include <functional>
#include <string>

namespace thimble::test {

enum class Rights {
  AsTheTest,
  None,  // no user but "nobody", no capability, real-time and memory-lock limits at 0
};

// Runs `function` in a forked child, so that what it does to the process stays there; returns
// what it returned, or "child died" when it did not come that far.
std::string in_child_process(Rights rights, const std::function<std::string()>& function);

}  // namespace thimble::test
