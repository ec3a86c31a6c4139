#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/coupling/arm_pair.hpp"
#include "daemon/session/arm_host.hpp"
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
  // Errors: the first thing that cannot be had, named by arm or world. What somebody else holds is
  // waited for, kBusyPatience at most for each arm; RigParts::on_wait hears why. A real arm that is
  // not there, or cannot be opened, whatever the reason, is no error: it is Lost, and looked for as
  // long as it is. The configuration is inspected (session::inspect()) before.
  [[nodiscard]] static Result<std::unique_ptr<Runtime>> create(const config::Config& config,
                                                               const RigParts& parts);

  [[nodiscard]] std::vector<std::unique_ptr<ArmRig>>& arms() noexcept { return arms_; }
  [[nodiscard]] std::vector<std::unique_ptr<WorldHost>>& worlds() noexcept { return worlds_; }
  [[nodiscard]] const std::vector<std::unique_ptr<ArmHost>>& arm_hosts() const noexcept {
    return arm_hosts_;
  }
  // nullptr: no arm of that name listens.
  [[nodiscard]] const ArmHost* find_arm_host(std::string_view name) const noexcept;
  // nullptr: no world of that name.
  [[nodiscard]] WorldHost* find_world(std::string_view name) noexcept;
  // A slice of the edits that wait for each world where one is due, then everything that is due on
  // all links; returns when to come again at the latest. Call it as often as you like.
  std::optional<MonotonicTime> pump(MonotonicTime now);
  // Arrivals and departures: every arm on a bus hears of each, whoever else is on that bus.
  // Call it every few ms, `now` on the caller's clock. What went wrong just now, for the log.
  // Opens, too, the real arms that were not there at the start, as soon as they can be had and
  // their stand-ins rest: see take_arrivals().
  [[nodiscard]] std::vector<Error> follow_buses(MonotonicTime now);

  // A real arm, opened, that was awaited.
  struct Arrival {
    std::size_t arm{0};  // index in arms()
    std::unique_ptr<ArmRig> rig;
  };
  // What follow_buses() opened. Each is to be put in its place at once.
  [[nodiscard]] std::vector<Arrival> take_arrivals() { return std::exchange(arrivals_, {}); }
  // Puts it in the place of the rig that kept it, and gives that one: no servo may run on it any
  // more. An arm that had a stand-in is not active, whatever the configuration says: nobody asked
  // for that one.
  std::unique_ptr<ArmRig> take_over(Arrival arrival);

  // Ours. The guard of a daemon that died holds its arm for 120 ms (guard::WatchSettings), and for
  // longer on a busy machine; who starts a second daemon by mistake need not wait long.
  static constexpr Duration kBusyPatience = std::chrono::seconds(2);

 private:
  Runtime(const config::Config& config, const RigParts& parts);
  [[nodiscard]] std::unique_ptr<coupling::WorldCoupling> make_peer_half(
      const config::ArmConfig& arm);
  [[nodiscard]] Result<std::unique_ptr<ArmRig>> make_rig(const config::ArmConfig& said);
  [[nodiscard]] Result<std::unique_ptr<ArmRig>> make_rig_when_free(const config::ArmConfig& said);
  [[nodiscard]] Result<std::unique_ptr<ArmRig>> make_first_rig(const config::ArmConfig& said);
  void tell_events_of(bus::BusEnumerator& buses);
  Result<void> follow_awaited(std::size_t arm, MonotonicTime now);

  config::ServoConfig servo_;
  RigParts parts_;
  // Of arms that are coupled to each other, by the name that comes first.
  std::map<std::string, coupling::ArmPair, std::less<>> pairs_;

  // The order matters: links on the arms' side use the worlds.
  std::vector<std::unique_ptr<WorldHost>> worlds_;
  std::vector<std::unique_ptr<ArmHost>> arm_hosts_;
  std::vector<std::unique_ptr<ArmRig>> arms_;
  std::vector<Arrival> arrivals_;
};

}  // namespace thimble::session
