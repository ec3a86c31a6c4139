#pragma once

#include "daemon/api/status.hpp"
#include "daemon/app/lateness_watch.hpp"
#include "daemon/app/leases.hpp"
#include "daemon/app/recording_book.hpp"
#include "daemon/app/servo_threads.hpp"
#include "daemon/session/runtime.hpp"
#include "daemon/session/safety_session.hpp"

namespace thimble::app {

// What the status needs besides the runtime itself; see api::Status for the meaning.
struct StatusContext {
  const Leases& leases;
  const ServoThreads* threads{nullptr};  // nullptr before they run
  const RecordingBook& recordings;
  const LatenessWatch& lateness;
  MonotonicTime started{};
  MonotonicTime now{};
  const session::SafetySession* safety{nullptr};  // nullptr: no such lines
};

// Takes the state of everything. Thread: the net plane's one thread. Not RT.
[[nodiscard]] api::Status collect_status(session::Runtime& runtime, const StatusContext& context);

}  // namespace thimble::app
