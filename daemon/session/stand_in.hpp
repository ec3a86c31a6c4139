#pragma once

#include <optional>
#include <string>

#include "daemon/config/config.hpp"
#include "daemon/session/arm_opening.hpp"
#include "daemon/session/retry_pace.hpp"
#include "hal/base/result.hpp"
#include "hal/bus/bus_enumerator.hpp"
#include "hal/plugin/sim_model.hpp"

namespace thimble::session {

// What the configuration of `arm` becomes while a simulated one stands in for it: the same but for
// its device, and with a person who holds it. The simulated one has the name of arm.model; where
// there is one that needs no upload ("-loaded"), that one. Errors: NotFound, naming those there
// are.
[[nodiscard]] Result<config::ArmConfig> stand_in_for(const config::ArmConfig& arm,
                                                     const plugin::SimModelRegistry& models);

// A real arm that could not be had at the start; a simulated one stands in for it, or nothing does.
// It is looked for when the bus tells of it, and now and then by itself.
//
// Thread: control thread. Ownership: `executor` must outlive it.
class AwaitedArm {
 public:
  AwaitedArm(OpenRequest request, std::string stand_in, devices::DeviceExecutor& executor)
      : request_(std::move(request)), stand_in_(std::move(stand_in)), opener_(executor) {}
  // Nothing stands in. `why` it could not be had, with its name in front.
  AwaitedArm(OpenRequest request, const Error& why, devices::DeviceExecutor& executor)
      : request_(std::move(request)), trouble_(why.message), opener_(executor) {}

  // As the configuration has it.
  [[nodiscard]] const config::ArmConfig& arm() const noexcept { return request_.arm; }
  [[nodiscard]] bool has_stand_in() const noexcept { return !stand_in_.empty(); }
  void on_bus_event(const bus::BusEvent& event);
  // Never waits for it: posts a search, and looks at each call whether its answer is there.
  // Looks for it when that is due, and opens it where it may take over. Something: it is there, and
  // opened or refused. `is_resting`: the stand-in is Inactive, and nobody wants it otherwise; true
  // where there is none. `now` is the caller's own time.
  [[nodiscard]] std::optional<Result<Opened>> follow(MonotonicTime now, bool is_resting);
  // That a search does not end, once for each: for the log. Errors: Timeout, with the arm's name.
  Result<void> tell_lateness(MonotonicTime now);
  // What follow() found came to nothing.
  void fail_with(const Error& error) { trouble_ = error.message; }
  // How it stands, for a person.
  [[nodiscard]] std::string sentence() const;

 private:
  OpenRequest request_;
  std::string stand_in_;
  bool is_there_{false};
  bool was_resting_{false};
  std::string trouble_;
  std::string late_;  // why a search does not end; empty: it does
  RetryPace pace_;    // as a lost arm's
  ArmOpener opener_;
};

}  // namespace thimble::session
