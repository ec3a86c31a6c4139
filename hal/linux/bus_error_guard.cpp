#include "hal/linux/bus_error_guard.hpp"

#include <signal.h>
#include <sys/mman.h>

#include <cerrno>

namespace thimble::linux {
namespace {

// Only its own thread's handler looks at it, between two instructions of that thread.
GuardedMapping*& guarded_here() noexcept {
  thread_local GuardedMapping* mapping = nullptr;
  return mapping;
}

struct sigaction& earlier_action() noexcept {
  static struct sigaction action {};
  return action;
}

bool put_zeros_in_its_place(GuardedMapping& mapping) noexcept {
  return ::mmap(mapping.memory.data(), mapping.memory.size(), PROT_READ | PROT_WRITE,
                MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
}

// Only what a handler may: mmap() is a plain system call.
void on_bus_error(int signal, siginfo_t* info, void* /*context*/) {
  const int error = errno;
  GuardedMapping* mapping = guarded_here();
  const auto* at = static_cast<const std::byte*>(info->si_addr);
  const bool is_ours = mapping != nullptr && at >= mapping->memory.data() &&
                       at < mapping->memory.data() + mapping->memory.size();
  if (is_ours && put_zeros_in_its_place(*mapping)) {
    mapping->is_gone.store(true);
  } else {
    ::sigaction(signal, &earlier_action(), nullptr);  // the access is tried again, and is theirs
  }
  errno = error;
}

bool take_the_signal() noexcept {
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  return ::sigaction(SIGBUS, &action, &earlier_action()) == 0;
}

}  // namespace

BusErrorGuard::BusErrorGuard(GuardedMapping& mapping) noexcept : before_(guarded_here()) {
  static const bool kIsTaken = take_the_signal();
  static_cast<void>(kIsTaken);
  guarded_here() = &mapping;
  std::atomic_signal_fence(std::memory_order_seq_cst);
}

BusErrorGuard::~BusErrorGuard() {
  std::atomic_signal_fence(std::memory_order_seq_cst);
  guarded_here() = before_;
}

}  // namespace thimble::linux
