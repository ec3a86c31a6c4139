#pragma once

#include <pthread.h>

namespace thimble::rt {

// A mutex between a thread with a real-time priority and ordinary ones: whoever holds it runs as
// urgently as the most urgent one that waits for it. With a std::mutex a busy machine may keep the
// holder from the processor, and with it the one that waits, for as long as it likes.
// pthread_mutexattr_setprotocol(3): PTHREAD_PRIO_INHERIT. BasicLockable and Lockable.
//
// Thread: any. Not RT: it may wait. Ownership: whoever locked it unlocks it, and it outlives both.
class InheritingMutex {
 public:
  InheritingMutex() noexcept {
    pthread_mutexattr_t attributes;
    ::pthread_mutexattr_init(&attributes);
    // Refused by a kernel without such locks: then it is one that does not inherit.
    ::pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    if (::pthread_mutex_init(&mutex_, &attributes) != 0) ::pthread_mutex_init(&mutex_, nullptr);
    ::pthread_mutexattr_destroy(&attributes);
  }
  ~InheritingMutex() { ::pthread_mutex_destroy(&mutex_); }
  InheritingMutex(const InheritingMutex&) = delete;
  InheritingMutex& operator=(const InheritingMutex&) = delete;

  void lock() noexcept { ::pthread_mutex_lock(&mutex_); }
  void unlock() noexcept { ::pthread_mutex_unlock(&mutex_); }
  [[nodiscard]] bool try_lock() noexcept { return ::pthread_mutex_trylock(&mutex_) == 0; }

 private:
  pthread_mutex_t mutex_;
};

}  // namespace thimble::rt
