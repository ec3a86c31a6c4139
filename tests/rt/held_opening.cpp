#include "tests/rt/held_opening.hpp"

#include <dlfcn.h>
#include <fcntl.h>

#include <condition_variable>
#include <cstdarg>
#include <mutex>

namespace {

struct Held {
  std::mutex lock;
  std::condition_variable changed;
  std::string path;  // empty: none
  int waiting{0};
};

// Never destroyed: what is opened at the very end asks it as well.
Held& held() {
  static Held* const kHeld = new Held;
  return *kHeld;
}

void wait_while_held(const char* path) {
  std::unique_lock guard(held().lock);
  if (held().path.empty() || held().path != path) return;
  ++held().waiting;
  held().changed.wait(guard, [] { return held().path.empty(); });
  --held().waiting;
}

}  // namespace

namespace thimble::test {

HeldOpening::HeldOpening(const std::string& path) {
  const std::lock_guard guard(held().lock);
  held().path = path;
}

HeldOpening::~HeldOpening() { release(); }

int HeldOpening::waiting() const {
  const std::lock_guard guard(held().lock);
  return held().waiting;
}

void HeldOpening::release() {
  const std::lock_guard guard(held().lock);
  held().path.clear();
  held().changed.notify_all();
}

}  // namespace thimble::test

extern "C" __attribute__((visibility("default"))) int open(const char* path, int flags, ...) {
  static const auto kReal = reinterpret_cast<decltype(&open)>(::dlsym(RTLD_NEXT, "open"));
  wait_while_held(path);
  if ((flags & (O_CREAT | O_TMPFILE)) == 0) return kReal(path, flags);
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = va_arg(rest, mode_t);
  va_end(rest);
  return kReal(path, flags, mode);
}
