#include "daemon/session/runtime.hpp"

#include <utility>

namespace thimble::session {

Result<std::unique_ptr<Runtime>> Runtime::create(const config::Config& config,
                                                 const RigParts& parts) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<Runtime> runtime(new Runtime());
  for (const config::WorldConfig& said : config.worlds) {
    Result<std::unique_ptr<WorldHost>> host = WorldHost::create(said, parts);
    if (!host) return tl::unexpected(host.error());
    runtime->worlds_.push_back(*std::move(host));
  }
  for (const config::ArmConfig& said : config.arms) {
    WorldHost* world = said.world ? runtime->find_world(*said.world) : nullptr;
    Result<std::unique_ptr<ArmRig>> rig = ArmRig::create(said, config.servo, world, parts);
    if (!rig) return tl::unexpected(rig.error());
    runtime->arms_.push_back(*std::move(rig));
  }
  return runtime;
}

WorldHost* Runtime::find_world(std::string_view name) noexcept {
  for (const auto& host : worlds_) {
    if (host->name() == name) return host.get();
  }
  return nullptr;
}

std::optional<MonotonicTime> Runtime::pump(MonotonicTime now) {
  std::optional<MonotonicTime> earliest;
  // Before the links: who asks next is answered by what the cells are now.
  for (const auto& host : worlds_) {
    const std::optional<MonotonicTime> due = host->pump_edits(now);
    if (due && (!earliest || *due < *earliest)) earliest = due;
  }
  for (const auto& arm : arms_) {
    const std::optional<MonotonicTime> due = arm->pump(now);
    if (due && (!earliest || *due < *earliest)) earliest = due;
  }
  return earliest;
}

std::vector<Error> Runtime::follow_buses(MonotonicTime now) {
  // A bus that two arms share is read twice: the second time it has nothing to say.
  for (const auto& arm : arms_) tell_events_of(arm->buses());
  std::vector<Error> troubles;
  for (const auto& arm : arms_) {
    Result<void> followed = arm->follow(now);
    if (!followed) troubles.push_back(std::move(followed.error()));
  }
  return troubles;
}

void Runtime::tell_events_of(bus::BusEnumerator& buses) {
  while (const std::optional<bus::BusEvent> event = buses.poll_event()) {
    for (const auto& arm : arms_) {
      if (&arm->buses() == &buses) arm->session().on_bus_event(*event);
    }
  }
}

}  // namespace thimble::session
