#include "tests/rt/refused_threads.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cerrno>
#include <cstddef>

namespace {
thread_local constinit int refusals = 0;
}  // namespace

namespace thimble::test {
RefusedThreads::RefusedThreads() noexcept { ++refusals; }
RefusedThreads::~RefusedThreads() { --refusals; }
}  // namespace thimble::test

extern "C" __attribute__((visibility("default"))) int pthread_attr_setstacksize(
    pthread_attr_t* attributes, std::size_t bytes) {
  static const auto kReal = reinterpret_cast<decltype(&pthread_attr_setstacksize)>(
      ::dlsym(RTLD_NEXT, "pthread_attr_setstacksize"));
  return refusals > 0 ? EAGAIN : kReal(attributes, bytes);
}
