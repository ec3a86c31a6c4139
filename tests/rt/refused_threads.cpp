#include "tests/rt/refused_threads.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cerrno>
#include <optional>

namespace {
using Which = thimble::test::RefusedThreads::Which;
thread_local constinit std::optional<Which> refused{};
}  // namespace

namespace thimble::test {
RefusedThreads::RefusedThreads(Which which) noexcept { refused = which; }
RefusedThreads::~RefusedThreads() { refused.reset(); }
}  // namespace thimble::test

extern "C" __attribute__((visibility("default"))) int pthread_create(
    pthread_t* handle, const pthread_attr_t* attributes, void* (*entry)(void*), void* argument) {
  static const auto kReal =
      reinterpret_cast<decltype(&pthread_create)>(::dlsym(RTLD_NEXT, "pthread_create"));
  if (refused && (*refused == Which::All || attributes != nullptr)) return EAGAIN;
  return kReal(handle, attributes, entry, argument);
}
