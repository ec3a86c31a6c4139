#include "daemon/session/arm_session.hpp"

#include <utility>

#include "daemon/devices/gone_device.hpp"
#include "daemon/devices/returned_arm.hpp"
#include "daemon/session/arm_settings.hpp"

namespace thimble::session {
namespace {

OpenRequest request_for(const config::ArmConfig& arm, const ArmSessionParts& parts) {
  return {arm, &parts.buses, &parts.drivers, &parts.clock};
}

}  // namespace

ArmSession::ArmSession(const config::ArmConfig& arm, const ArmSessionParts& parts,
                       std::unique_ptr<HapticDevice> device,
                       std::unique_ptr<coupling::ArmCoupling> coupling)
    : arm_(arm),
      parts_(parts),
      device_(std::move(device), parts.executor),
      coupling_(std::make_unique<coupling::SteadyForce>(std::move(coupling))),
      guard_("arm '" + arm.name + "'", {arm.device}, parts.guards, controls_),
      request_(request_for(arm, parts)),
      opener_(parts.executor) {
  controls_.want_active = arm.activate;
}

Result<std::unique_ptr<ArmSession>> ArmSession::make(const config::ArmConfig& arm,
                                                     const config::ServoConfig& servo,
                                                     const ArmSessionParts& parts,
                                                     std::unique_ptr<HapticDevice> device) {
  const Result<servo::ServoSettings> settings = servo_settings(arm, servo, device->capabilities());
  Result<std::unique_ptr<coupling::ArmCoupling>> coupling =
      make_coupling(arm, parts.cell_m, device->capabilities());
  if (!settings || !coupling) {
    parts.executor.close(std::move(device));
    return tl::unexpected(settings ? coupling.error() : settings.error());
  }
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<ArmSession> session(
      new ArmSession(arm, parts, std::move(device), *std::move(coupling)));
  session->settings_ = *settings;
  session->settings_.entry = parts.entry;
  return session;
}

void ArmSession::make_loop(bool is_lost) {
  loop_ = std::make_unique<servo::ServoLoop>(
      servo::ServoParts{device_, *coupling_, parts_.link, controls_, parts_.clock, parts_.stopwatch,
                        guard_.heartbeat(), is_lost},
      settings_);
}

Result<std::unique_ptr<ArmSession>> ArmSession::create(const config::ArmConfig& arm,
                                                       const config::ServoConfig& servo,
                                                       const ArmSessionParts& parts) {
  auto opened = opened_of(open_and_wait(request_for(arm, parts), parts.executor, parts.clock));
  if (!opened) return tl::unexpected(opened.error().in("arm '" + arm.name + "'"));
  return create(arm, servo, parts, *std::move(opened));
}

Result<std::unique_ptr<ArmSession>> ArmSession::create(const config::ArmConfig& arm,
                                                       const config::ServoConfig& servo,
                                                       const ArmSessionParts& parts,
                                                       Opened opened) {
  const std::string name = "arm '" + arm.name + "'";
  Result<std::unique_ptr<ArmSession>> session = make(arm, servo, parts, std::move(opened.device));
  if (!session) return tl::unexpected(session.error().in(name));
  (*session)->request_.left = std::move(opened.info);
  const Result<void> guarded = (*session)->guard_.begin((*session)->device_);
  if (!guarded) return tl::unexpected(guarded.error());
  (*session)->make_loop(false);
  return session;
}

Result<std::unique_ptr<ArmSession>> ArmSession::create_lost(const config::ArmConfig& arm,
                                                            const config::ServoConfig& servo,
                                                            const ArmSessionParts& parts) {
  HapticCapabilities nothing;
  nothing.model = arm.model.value_or("");
  nothing.is_actuated = false;
  Result<std::unique_ptr<ArmSession>> session =
      make(arm, servo, parts, std::make_unique<devices::GoneDevice>(std::move(nothing)));
  if (!session) return tl::unexpected(session.error().in("arm '" + arm.name + "'"));
  (*session)->is_rate_known_ = servo.rate_hz.has_value();
  (*session)->make_loop(true);
  return session;
}

std::optional<double> ArmSession::rate_hz() const noexcept {
  return is_rate_known_ ? std::optional(settings_.rate_hz) : std::nullopt;
}

const servo::ServoSnapshot& ArmSession::snapshot() {
  servo::ServoSnapshot fresh;
  if (loop_->snapshot(fresh)) snapshot_ = fresh;
  return snapshot_;
}

std::optional<Recording> ArmSession::take_recording() {
  if (!loop_->recorder().is_frozen()) return std::nullopt;
  servo::FlightStop stop = loop_->recorder().take();
  Recording recording;
  recording.frames = std::move(stop.frames);
  recording.header = {arm_.name, arm_.device, stop.cause, stop.without_room};
  return recording;
}

void ArmSession::on_bus_event(const bus::BusEvent& event) {
  const bool is_ours = event.device.address.text == arm_.device;
  if (!is_ours || event.kind != bus::BusEvent::Kind::Arrived) return;
  pace_.restart();
}

Result<void> ArmSession::follow(MonotonicTime now) {
  device_.collect();
  if (!is_lost_for_servo()) {
    trouble_.clear();
    // What is being closed is given to no guard: ArmGuard::ask().
    if (device_.is_retired()) return {};
    // One that dies before its first report was never had: the tries go on as rare as they were.
    if (device_.has_reported()) pace_.restart();
    Result<void> guarded = guard_.follow(now);
    if (!guarded) trouble_ = guarded.error().message;
    return guarded;
  }
  // The dead handle goes first: decision 0150.
  if (device_.retire()) {
    offered_at_tick_ = snapshot().frame.tick;
    return {};
  }
  if (!opener_.is_under_way()) {
    if (!pace_.is_due(now)) return {};
    pace_.tried(now);
    opener_.begin(request_, now);
  }
  std::optional<OpenOutcome> outcome = opener_.take();
  if (!outcome) return note_lateness(now);
  Result<void> back = take_back(*std::move(outcome));
  trouble_ = back ? "" : back.error().message;
  return back;
}

Result<void> ArmSession::note_lateness(MonotonicTime now) {
  const std::string late = opener_.lateness(now);
  if (late.empty()) return {};
  const std::string name = "arm '" + arm_.name + "'";
  trouble_ = name + ": " + late;
  Result<void> told = opener_.tell_lateness(now);
  return told ? told : tl::unexpected(told.error().in(name));
}

// The state of a tick that began after the newest offer: an older one tells of the old device.
bool ArmSession::is_lost_for_servo() {
  const servo::ServoFrame& frame = snapshot().frame;
  const bool is_seen_since = offered_at_tick_ == 0 || frame.tick >= offered_at_tick_ + 2;
  return is_seen_since && frame.state == OperatingState::Lost;
}

Result<void> ArmSession::take_back(OpenOutcome outcome) {
  if (std::holds_alternative<NotThere>(outcome)) return {};  // which the state says already
  const std::string refusal = "arm '" + arm_.name + "' is back but cannot be opened";
  Result<Opened> opened = opened_of(std::move(outcome));
  if (!opened) return tl::unexpected(opened.error().in(refusal));
  Result<void> offered = offer(opened->device, refusal);
  if (!offered) opener_.give_back(*std::move(opened));
  return offered;
}

Result<void> ArmSession::offer(std::unique_ptr<HapticDevice>& device, const std::string& refusal) {
  const Result<void> is_alike =
      devices::check_same_limits(device_.capabilities(), device->capabilities());
  if (!is_alike) return tl::unexpected(is_alike.error().in(refusal));
  Result<void> guarded = guard_.begin(*device);
  if (!guarded) return guarded;
  device->forget_calibration();
  if (!device_.offer(device)) return fail(Errc::Busy, "arm '" + arm_.name + "' is being replaced");
  offered_at_tick_ = snapshot().frame.tick;
  return {};
}

}  // namespace thimble::session
