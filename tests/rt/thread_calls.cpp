#include "tests/rt/thread_calls.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>

#ifdef THIMBLE_UNDER_SANITIZER
#define THIMBLE_TEST_COUNTS 0
#else
#define THIMBLE_TEST_COUNTS 1
#endif

namespace {
// Constant-initialised and without destructor: usable before and after everything else.
thread_local constinit thimble::test::ThreadCalls calls{};
}  // namespace

namespace thimble::test {
bool can_count_thread_calls() noexcept { return THIMBLE_TEST_COUNTS != 0; }
ThreadCalls thread_calls() noexcept { return calls; }
}  // namespace thimble::test

#if THIMBLE_TEST_COUNTS

// The allocator's own names, exported by glibc for exactly this use: they are not ours to choose.
// NOLINTBEGIN(readability-identifier-naming)
#ifdef __clang__
#pragma clang diagnostic ignored "-Wreserved-identifier"
#endif
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
}
// NOLINTEND(readability-identifier-naming)

namespace {

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

void* aligned(std::size_t alignment, std::size_t size) {
  ++calls.allocations;
  return __libc_memalign(alignment, size);
}

}  // namespace

#define THIMBLE_TEST_EXPORT extern "C" __attribute__((visibility("default")))

THIMBLE_TEST_EXPORT void* malloc(std::size_t size) {
  ++calls.allocations;
  return __libc_malloc(size);
}
THIMBLE_TEST_EXPORT void* calloc(std::size_t count, std::size_t size) {
  ++calls.allocations;
  return __libc_calloc(count, size);
}
THIMBLE_TEST_EXPORT void* realloc(void* memory, std::size_t size) {
  ++calls.allocations;
  return __libc_realloc(memory, size);
}
THIMBLE_TEST_EXPORT void* memalign(std::size_t alignment, std::size_t size) {
  return aligned(alignment, size);
}
THIMBLE_TEST_EXPORT void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return aligned(alignment, size);
}
THIMBLE_TEST_EXPORT int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  void* const memory = aligned(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *out = memory;
  return 0;
}
THIMBLE_TEST_EXPORT void free(void* memory) {
  if (memory != nullptr) ++calls.frees;
  __libc_free(memory);
}

THIMBLE_TEST_EXPORT int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static const auto kLock = real<decltype(&pthread_mutex_lock)>("pthread_mutex_lock");
  ++calls.locks;
  return kLock(mutex);
}
THIMBLE_TEST_EXPORT int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static const auto kLock = real<decltype(&pthread_mutex_trylock)>("pthread_mutex_trylock");
  ++calls.locks;
  return kLock(mutex);
}
THIMBLE_TEST_EXPORT int pthread_rwlock_rdlock(pthread_rwlock_t* rwlock) {
  static const auto kLock = real<decltype(&pthread_rwlock_rdlock)>("pthread_rwlock_rdlock");
  ++calls.locks;
  return kLock(rwlock);
}
THIMBLE_TEST_EXPORT int pthread_rwlock_wrlock(pthread_rwlock_t* rwlock) {
  static const auto kLock = real<decltype(&pthread_rwlock_wrlock)>("pthread_rwlock_wrlock");
  ++calls.locks;
  return kLock(rwlock);
}

#endif
