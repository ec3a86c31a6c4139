#include "hal/linux/memory_lock.hpp"

#include <linux/capability.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace thimble::linux {
namespace {

// A sanitizer's thread-local storage alone may be larger than a small stack, and it ignores
// mlockall(): there the usual stacks stay.
#ifdef THIMBLE_UNDER_SANITIZER
constexpr bool kNeedsUsualStacks = true;
#else
constexpr bool kNeedsUsualStacks = false;
#endif

bool has_capability(unsigned capability) noexcept {
  __user_cap_header_struct header{};
  header.version = _LINUX_CAPABILITY_VERSION_3;
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> data{};
  if (::syscall(SYS_capget, &header, data.data()) != 0) return false;
  return (data[capability / 32].effective & (1U << (capability % 32))) != 0;
}

bool may_lock_without_limit() noexcept {
  if (has_capability(CAP_IPC_LOCK)) return true;
  rlimit limit{};
  if (::getrlimit(RLIMIT_MEMLOCK, &limit) != 0 || limit.rlim_max != RLIM_INFINITY) return false;
  limit.rlim_cur = RLIM_INFINITY;
  return ::setrlimit(RLIMIT_MEMLOCK, &limit) == 0;
}

// One arena: each further one would reserve, and so lock, memory of its own. The servo
// allocates nothing, so nobody who matters waits for the arena's lock.
void make_allocator_keep_its_memory() noexcept {
  ::mallopt(M_ARENA_MAX, 1);
  ::mallopt(M_TRIM_THRESHOLD, -1);
  ::mallopt(M_MMAP_MAX, 0);
}

}  // namespace

Result<void> set_default_thread_stack(std::size_t bytes) {
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  int error = ::pthread_attr_setstacksize(&attributes, bytes);
  if (error == 0 && !kNeedsUsualStacks) error = ::pthread_setattr_default_np(&attributes);
  ::pthread_attr_destroy(&attributes);
  if (error == 0) return {};
  return fail(Errc::InvalidArgument,
              "thread stack of " + std::to_string(bytes) + " bytes: " + std::strerror(error));
}

Result<void> refuse_huge_pages() {
  if (::prctl(PR_SET_THP_DISABLE, 1UL, 0UL, 0UL, 0UL) == 0) return {};
  return fail(Errc::System, std::string("huge pages cannot be refused: ") + std::strerror(errno) +
                                "; turn transparent_hugepage off on the kernel's command line");
}

Result<void> lock_memory() {
  static constexpr const char* kCure =
      ": needs RLIMIT_MEMLOCK unlimited or CAP_IPC_LOCK; set LimitMEMLOCK=infinity in the unit or "
      "'memlock unlimited' in /etc/security/limits.d";
  if (!may_lock_without_limit()) {
    return fail(Errc::Permission, std::string("memory lock refused") + kCure);
  }
  make_allocator_keep_its_memory();
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  return fail(errno == EPERM ? Errc::Permission : Errc::System,
              std::string("memory lock refused (") + std::strerror(errno) + ")" + kCure);
}

}  // namespace thimble::linux
