#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/api/status.hpp"
#include "daemon/app/lateness_watch.hpp"
#include "daemon/app/leases.hpp"
#include "daemon/app/servo_threads.hpp"
#include "daemon/session/runtime.hpp"

namespace thimble::app {

// By the arm's name and what stopped it: the path of the newest such recording, or why it could not
// be written.
using Recordings = std::map<std::pair<std::string, FaultCode>, std::string>;

// What the status needs besides the runtime itself; see api::Status for the meaning.
struct StatusContext {
  const Leases& leases;
  const ServoThreads* threads{nullptr};  // nullptr before they run
  const Recordings& recordings;
  const LatenessWatch& lateness;
  MonotonicTime started{};
  MonotonicTime now{};
};

// Takes the state of everything. Thread: the net plane's one thread. Not RT.
[[nodiscard]] api::Status collect_status(session::Runtime& runtime, const StatusContext& context);

}  // namespace thimble::app
