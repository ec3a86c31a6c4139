#include "hal/linux/realtime_thread.hpp"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <semaphore>
#include <utility>

#include "hal/linux/memory_lock.hpp"

namespace thimble::linux {

struct RealtimeThread::Shared {
  RealtimeThreadSettings settings;
  RealtimeReport report;
  std::function<void()> body;
  pthread_t handle{};
  std::binary_semaphore rights_known{0};
  std::binary_semaphore decided{0};
  bool may_run{false};
};

namespace {

std::string priority_refusal(int priority, int error) {
  const std::string p = std::to_string(priority);
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  return "SCHED_FIFO priority " + p + " refused (" + std::strerror(error) +
         "): needs RLIMIT_RTPRIO >= " + p + " (now " + std::to_string(limit.rlim_cur) +
         ") or CAP_SYS_NICE; set LimitRTPRIO=" + p + " in the unit or 'rtprio " + p +
         "' in /etc/security/limits.d";
}

void take_priority(int priority, RealtimeReport& report) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
  report.has_fifo = error == 0;
  if (error != 0) report.missing.push_back(priority_refusal(priority, error));
}

void pin(std::optional<unsigned> cpu, RealtimeReport& report) {
  report.has_affinity = true;
  if (!cpu.has_value()) return;
  int error = EINVAL;
  if (*cpu < CPU_SETSIZE) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(*cpu, &set);
    error = ::pthread_setaffinity_np(::pthread_self(), sizeof(set), &set);
  }
  report.has_affinity = error == 0;
  if (error == 0) return;
  report.missing.push_back("CPU " + std::to_string(*cpu) + " refused (" + std::strerror(error) +
                           "): needs that CPU to exist and to be allowed to this process; choose "
                           "another one or change AllowedCPUs= of the unit");
}

void flush_denormals() noexcept {
#if defined(__SSE2__)
  constexpr unsigned kFlushToZero = 0x8000;       // MXCSR.FTZ, Intel SDM vol. 1, 10.2.3
  constexpr unsigned kDenormalsAreZero = 0x0040;  // MXCSR.DAZ
  __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | kFlushToZero | kDenormalsAreZero);
#endif
}

// Touches the unused part of the stack once, so that no page of it is missing later. What lies
// above is in use by then: thread-local storage, the frames of the callers.
[[gnu::noinline]] void prefault_stack() noexcept {
  constexpr std::size_t kPageBytes = 4096;
  constexpr std::size_t kMarginBytes = 4 * kPageBytes;  // guard page and this frame
  pthread_attr_t attributes;
  if (::pthread_getattr_np(::pthread_self(), &attributes) != 0) return;
  void* lowest = nullptr;
  std::size_t size = 0;
  ::pthread_attr_getstack(&attributes, &lowest, &size);
  ::pthread_attr_destroy(&attributes);

  const auto* here = static_cast<const char*>(__builtin_frame_address(0));
  const auto unused = static_cast<std::size_t>(here - static_cast<const char*>(lowest));
  if (unused <= kMarginBytes || unused > size) return;
  auto* bytes = static_cast<volatile char*>(__builtin_alloca(unused - kMarginBytes));
  for (std::size_t i = 0; i < unused - kMarginBytes; i += kPageBytes) bytes[i] = 0;
}

// Signals of the process are for the control thread: none may interrupt a tick.
void block_signals(sigset_t& previous) noexcept {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &previous);
}

int create_thread(pthread_t& handle, void* (*entry)(void*), void* argument) {
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  int error = ::pthread_attr_setstacksize(&attributes, kThreadStackBytes);
  sigset_t previous;
  block_signals(previous);  // inherited, so that there is no moment without it
  if (error == 0) error = ::pthread_create(&handle, &attributes, entry, argument);
  ::pthread_sigmask(SIG_SETMASK, &previous, nullptr);
  ::pthread_attr_destroy(&attributes);
  return error;
}

std::string thread_refusal(const std::string& name, int error) {
  std::string refused = "thread '" + name + "' refused (" + std::strerror(error) + ")";
  if (error != EAGAIN) return refused;  // pthread_create(3): limits, or no memory
  return refused +
         ": there are as many as may be; name fewer arms, or raise TasksMax= and LimitNPROC= of "
         "the unit ('ulimit -u' of a shell)";
}

}  // namespace

Result<std::unique_ptr<RealtimeThread>> RealtimeThread::start(
    const RealtimeThreadSettings& settings, const RealtimeReport& process,
    std::function<void()> body) {
  if (settings.priority < 1 || settings.priority > kMaxPriority) {
    return fail(Errc::InvalidArgument,
                "priority " + std::to_string(settings.priority) + " is not in 1 to 98");
  }
  auto shared = std::make_unique<Shared>();
  shared->settings = settings;
  shared->report = process;
  shared->body = std::move(body);
  const auto entry = [](void* argument) noexcept -> void* {
    auto* self = static_cast<Shared*>(argument);
    ::pthread_setname_np(::pthread_self(), self->settings.name.substr(0, 15).c_str());
    take_priority(self->settings.priority, self->report);
    pin(self->settings.cpu, self->report);
    flush_denormals();
    prefault_stack();
    self->rights_known.release();
    self->decided.acquire();
    if (self->may_run) self->body();
    return nullptr;
  };
  if (const int error = create_thread(shared->handle, entry, shared.get()); error != 0) {
    return fail(Errc::System, thread_refusal(settings.name, error));
  }
  shared->rights_known.acquire();
  const Result<void> decision = enforce(settings.policy, shared->report);
  shared->may_run = decision.has_value();
  shared->decided.release();
  std::unique_ptr<RealtimeThread> thread(new RealtimeThread(std::move(shared)));
  if (!decision.has_value()) return tl::unexpected<Error>(decision.error());
  return thread;
}

RealtimeThread::RealtimeThread(std::unique_ptr<Shared> shared) noexcept
    : shared_(std::move(shared)) {}

RealtimeThread::~RealtimeThread() { ::pthread_join(shared_->handle, nullptr); }

const RealtimeReport& RealtimeThread::report() const noexcept { return shared_->report; }

}  // namespace thimble::linux
