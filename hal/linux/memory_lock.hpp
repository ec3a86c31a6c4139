#pragma once

#include <cstddef>

#include "hal/base/result.hpp"

namespace thimble::linux {

// Stack of every thread while memory is locked. Ours: a locked stack is resident in full, so
// the usual 8 MiB would cost a daemon of five threads 40 MiB.
inline constexpr std::size_t kThreadStackBytes = 256 * 1024;

// Stack size of the threads made from now on without a size of their own. Under a sanitizer it is
// looked at and not set: its thread-local storage alone may be larger.
// Thread: before the first thread is made. Not RT.
// Errors: InvalidArgument for a size that pthreads refuse (below PTHREAD_STACK_MIN).
[[nodiscard]] Result<void> set_default_thread_stack(std::size_t bytes);

// From now on the kernel makes no huge pages of this process's memory. Its khugepaged would, every
// ten seconds, of locked memory, too, and whoever touches that meanwhile waits: decision 0383.
// Thread: start-up; it holds for all threads, and for programs that they start. Not undone. Not RT.
// Errors: System, naming the cure, where the kernel refuses it.
[[nodiscard]] Result<void> refuse_huge_pages();

// Keeps every page of the process in memory, now and in future, and makes the allocator keep
// what it got: from then on it has one arena for all threads, who wait for each other in it, gives
// nothing back, and takes no block by mmap(), however large. Call set_default_thread_stack() first.
// The allocator stays so when the lock itself fails.
//
// Thread: start-up, before other threads. Not undone. Not RT.
// Errors: Permission, naming the right and the cure, when RLIMIT_MEMLOCK is finite and
// CAP_IPC_LOCK is missing, even if today's size would fit: a later allocation beyond the limit
// would fail in the middle of a run. System, with the same cure, when the kernel refuses it for
// another reason.
[[nodiscard]] Result<void> lock_memory();

}  // namespace thimble::linux
