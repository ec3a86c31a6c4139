#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>

#include "hal/base/time.hpp"
#include "sim/time/event_queue.hpp"

namespace thimble::sim {

// One-shot calls at points of virtual time, for the scripts of tests and the lab.
//
// Thread: as EventQueue. Not RT: every call allocates. Ownership: holds the pending calls;
// its destructor cancels them. The queue must outlive it.
class ScheduledCalls {
 public:
  using CallId = std::uint64_t;

  explicit ScheduledCalls(EventQueue& events) noexcept;
  ~ScheduledCalls();
  CallId schedule_at(MonotonicTime due, std::function<void(MonotonicTime)> function);
  // False when the call was made or cancelled before.
  bool cancel(CallId id) noexcept;

 private:
  class Call;
  EventQueue* events_;
  CallId next_id_{1};
  std::map<CallId, std::unique_ptr<Call>> pending_;
};

}  // namespace thimble::sim
