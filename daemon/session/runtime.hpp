#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/session/arm_rig.hpp"
#include "daemon/session/world_host.hpp"
#include "daemon/world/world.hpp"

namespace thimble::session {

// Everything a configuration describes, made: worlds, their listeners, arms with their links.
// Nothing runs until somebody ticks the servo loops and pumps.
//
// Thread: created and destroyed by the control thread; pump() and the statuses belong to the
//         net plane's one thread; each arm's loop to its servo thread.
class Runtime {
 public:
  // Errors: the first thing that cannot be had, named by arm or world.
  [[nodiscard]] static Result<std::unique_ptr<Runtime>> create(const config::Config& config,
                                                               const RigParts& parts);

  [[nodiscard]] std::vector<std::unique_ptr<ArmRig>>& arms() noexcept { return arms_; }
  [[nodiscard]] std::vector<std::unique_ptr<WorldHost>>& worlds() noexcept { return worlds_; }
  // nullptr: no world of that name.
  [[nodiscard]] WorldHost* find_world(std::string_view name) noexcept;
  // A slice of the edits that wait for each world where one is due, then everything that is due on
  // all links; returns when to come again at the latest. Call it as often as you like.
  std::optional<MonotonicTime> pump(MonotonicTime now);
  // Arrivals and departures: every arm on a bus hears of each, whoever else is on that bus.
  // Call it every few ms, `now` on the caller's clock. What went wrong just now, for the log.
  [[nodiscard]] std::vector<Error> follow_buses(MonotonicTime now);

 private:
  Runtime() = default;
  void tell_events_of(bus::BusEnumerator& buses);

  // The order matters: links on the arms' side use the worlds.
  std::vector<std::unique_ptr<WorldHost>> worlds_;
  std::vector<std::unique_ptr<ArmRig>> arms_;
};

}  // namespace thimble::session
