#include "hal/base/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace thimble {

void check_failed(const char* expression, const char* file, int line) noexcept {
  std::fprintf(stderr, "thimble: broken invariant: %s (%s:%d)\n", expression, file, line);
  std::abort();
}

}  // namespace thimble
