#include "daemon/session/runtime.hpp"

#include <algorithm>
#include <utility>

#include "daemon/link/earliest.hpp"
#include "daemon/session/arm_settings.hpp"
#include "daemon/session/combination.hpp"
#include "daemon/session/retry_pace.hpp"

namespace thimble::session {

Runtime::Runtime(const config::Config& config, const RigParts& parts)
    : servo_(config.servo), parts_(parts) {
  parts_.make_peer_half = [this](const config::ArmConfig& arm) { return make_peer_half(arm); };
}

// An arm that comes later has another rig, and another half of the same pair.
std::unique_ptr<coupling::WorldCoupling> Runtime::make_peer_half(const config::ArmConfig& arm) {
  if (const ArmHost* const host = find_arm_host(arm.name)) return host->make_half();
  if (!arm.peer) return nullptr;
  const bool is_first = arm.name < *arm.peer;
  const auto pair = pairs_.try_emplace(is_first ? arm.name : *arm.peer, parts_.first_session).first;
  return pair->second.make_half(
      is_first ? coupling::ArmPair::Side::First : coupling::ArmPair::Side::Second,
      answer_for(arm.coupling.scheme));
}

Result<std::unique_ptr<Runtime>> Runtime::create(const config::Config& config,
                                                 const RigParts& parts) {
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<Runtime> runtime(new Runtime(config, parts));
  for (const config::WorldConfig& said : config.worlds) {
    Result<std::unique_ptr<WorldHost>> host = WorldHost::create(said, parts);
    if (!host) return tl::unexpected(host.error());
    runtime->worlds_.push_back(*std::move(host));
  }
  for (const config::ArmConfig& said : config.arms) {
    if (!said.is_listening()) continue;
    auto host = ArmHost::create(said, parts);
    if (!host) return tl::unexpected(host.error());
    runtime->arm_hosts_.push_back(*std::move(host));
  }
  for (const config::ArmConfig& said : config.arms) {
    config::ArmConfig arm = said;
    for (std::size_t i = 0; i < config.worlds.size(); ++i) {
      const config::WorldConfig& world = config.worlds[i];
      // A map is of cells where they are: one that stands elsewhere goes by the ghost point.
      if (said.world != world.name || said.place_m != std::array<double, 3>{}) continue;
      arm.coupling.scheme = choose_scheme(runtime->worlds_[i]->world(), world, said.coupling);
    }
    Result<std::unique_ptr<ArmRig>> rig = runtime->make_first_rig(arm);
    if (!rig) return tl::unexpected(rig.error());
    runtime->arms_.push_back(*std::move(rig));
  }
  return runtime;
}

Result<std::unique_ptr<ArmRig>> Runtime::make_rig(const config::ArmConfig& said) {
  return ArmRig::create(said, servo_, said.world ? find_world(*said.world) : nullptr, parts_);
}

Result<std::unique_ptr<ArmRig>> Runtime::make_first_rig(const config::ArmConfig& said) {
  Result<std::unique_ptr<ArmRig>> rig = make_rig_when_free(said);
  if (rig || bus::is_simulated(said.device)) return rig;
  // Whatever it is: a device says of itself what it likes, and shall end no other arm by it. The
  // configuration was inspected before; what no device can mend is met once more without one.
  WorldHost* const world = said.world ? find_world(*said.world) : nullptr;
  return ArmRig::create_lost(said, servo_, world, parts_, rig.error());
}

// Only at the start, where no other arm runs that would miss who waits here.
Result<std::unique_ptr<ArmRig>> Runtime::make_rig_when_free(const config::ArmConfig& said) {
  Result<std::unique_ptr<ArmRig>> rig = make_rig(said);
  if (parts_.real_clock == nullptr) return rig;
  Clock& clock = *parts_.real_clock;
  const MonotonicTime deadline = clock.now() + kBusyPatience;
  RetryPace pace;
  while (!rig && rig.error().code == Errc::Busy && clock.now() < deadline) {
    if (!pace.next() && parts_.on_wait) parts_.on_wait(rig.error());
    pace.tried(clock.now());
    static_cast<void>(clock.sleep_until(std::min(*pace.next(), deadline)));
    rig = make_rig(said);
  }
  return rig;
}

const ArmHost* Runtime::find_arm_host(std::string_view name) const noexcept {
  for (const auto& host : arm_hosts_) {
    if (host->name() == name) return host.get();
  }
  return nullptr;
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
    link::take_earlier(earliest, host->pump(now));
  }
  for (const auto& arm : arms_) {
    link::take_earlier(earliest, arm->pump(now));
  }
  return earliest;
}

std::vector<Error> Runtime::follow_buses(MonotonicTime now) {
  // A bus that two arms share is read twice: the second time it has nothing to say.
  for (const auto& arm : arms_) {
    tell_events_of(arm->buses());
    if (arm->awaited() != nullptr) tell_events_of(*parts_.real_buses);
  }
  std::vector<Error> troubles;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    Result<void> followed = arms_[i]->follow(now);
    if (!followed) troubles.push_back(std::move(followed.error()));
    Result<void> awaited = follow_awaited(i, now);
    if (!awaited) troubles.push_back(std::move(awaited.error()));
  }
  return troubles;
}

Result<void> Runtime::follow_awaited(std::size_t arm, MonotonicTime now) {
  ArmRig& rig = *arms_[arm];
  AwaitedArm* const awaited = rig.awaited();
  if (awaited == nullptr) return {};
  ArmSession& before = rig.session();
  const bool is_wanted = before.controls().want_active;
  const bool is_resting = !awaited->has_stand_in() ||
                          (before.snapshot().frame.state == OperatingState::Inactive && !is_wanted);
  std::optional<Result<Opened>> found = awaited->follow(now, is_resting);
  if (!found) return awaited->tell_lateness(now);
  config::ArmConfig real = awaited->arm();
  real.fallback = config::Fallback::None;  // gone again, it is an arm that was lost
  WorldHost* const world = real.world ? find_world(*real.world) : nullptr;
  Result<std::unique_ptr<ArmRig>> opened =
      *found ? ArmRig::create_found(real, servo_, world, parts_, **std::move(found))
             : tl::unexpected(found->error().in("arm '" + real.name + "'"));
  if (!opened) {
    awaited->fail_with(opened.error());
    return tl::unexpected(opened.error());
  }
  // Who asked for a simulated arm did not ask for this one.
  (*opened)->session().controls().want_active = is_wanted && !awaited->has_stand_in();
  arrivals_.push_back({arm, *std::move(opened)});
  return {};
}

std::unique_ptr<ArmRig> Runtime::take_over(Arrival arrival) {
  return std::exchange(arms_.at(arrival.arm), std::move(arrival.rig));
}

void Runtime::tell_events_of(bus::BusEnumerator& buses) {
  while (const std::optional<bus::BusEvent> event = buses.poll_event()) {
    for (const auto& arm : arms_) {
      if (&arm->buses() == &buses) arm->session().on_bus_event(*event);
      if (AwaitedArm* const awaited = arm->awaited()) awaited->on_bus_event(*event);
    }
  }
}

}  // namespace thimble::session
