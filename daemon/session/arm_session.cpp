#include "daemon/session/arm_session.hpp"

#include <utility>

#include "daemon/devices/arm_opener.hpp"
#include "daemon/devices/gone_device.hpp"
#include "daemon/devices/returned_arm.hpp"
#include "daemon/session/arm_settings.hpp"

namespace thimble::session {
namespace {

Result<std::unique_ptr<HapticDevice>> open_device(const config::ArmConfig& arm,
                                                  const ArmSessionParts& parts) {
  plugin::DriverSettings settings = driver_settings(arm);
  settings.clock = &parts.clock;
  return devices::open_arm(parts.buses, parts.drivers, {arm.device}, settings);
}

}  // namespace

ArmSession::ArmSession(const config::ArmConfig& arm, const ArmSessionParts& parts,
                       std::unique_ptr<HapticDevice> device,
                       std::unique_ptr<coupling::ArmCoupling> coupling)
    : arm_(arm),
      parts_(parts),
      device_(std::move(device)),
      coupling_(std::make_unique<coupling::SteadyForce>(std::move(coupling))),
      guard_("arm '" + arm.name + "'", {arm.device}, parts.guards, controls_) {
  controls_.want_active = arm.activate;
}

Result<std::unique_ptr<ArmSession>> ArmSession::make(const config::ArmConfig& arm,
                                                     const config::ServoConfig& servo,
                                                     const ArmSessionParts& parts,
                                                     std::unique_ptr<HapticDevice> device) {
  const Result<servo::ServoSettings> settings = servo_settings(arm, servo, device->capabilities());
  if (!settings) return tl::unexpected(settings.error());
  Result<std::unique_ptr<coupling::ArmCoupling>> coupling =
      make_coupling(arm, parts.cell_m, device->capabilities());
  if (!coupling) return tl::unexpected(coupling.error());
  // The constructor is private, so make_unique cannot reach it.
  std::unique_ptr<ArmSession> session(
      new ArmSession(arm, parts, std::move(device), *std::move(coupling)));
  session->settings_ = *settings;
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
  const std::string name = "arm '" + arm.name + "'";
  const Result<bus::BusDeviceInfo> info = devices::find_device(parts.buses, {arm.device});
  Result<std::unique_ptr<HapticDevice>> device = open_device(arm, parts);
  if (!device) return tl::unexpected(device.error().in(name));
  Result<std::unique_ptr<ArmSession>> session = make(arm, servo, parts, *std::move(device));
  if (!session) return tl::unexpected(session.error().in(name));
  (*session)->identity_ = info.value_or(bus::BusDeviceInfo{});
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
  (*session)->make_loop(true);
  return session;
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
    // One that dies before its first report was never had: the tries go on as rare as they were.
    if (device_.counters().reports_in > 0) pace_.restart();
    Result<void> guarded = guard_.follow(now);
    if (!guarded) trouble_ = guarded.error().message;
    return guarded;
  }
  // The dead handle goes first: decision 0150.
  if (device_.retire()) {
    offered_at_tick_ = snapshot().frame.tick;
    return {};
  }
  if (!pace_.is_due(now)) return {};
  pace_.tried(now);
  Result<void> opened = reopen();
  trouble_ = opened ? "" : opened.error().message;
  return opened;
}

// The state of a tick that began after the newest offer: an older one tells of the old device.
bool ArmSession::is_lost_for_servo() {
  const servo::ServoFrame& frame = snapshot().frame;
  const bool is_seen_since = offered_at_tick_ == 0 || frame.tick >= offered_at_tick_ + 2;
  return is_seen_since && frame.state == OperatingState::Lost;
}

Result<void> ArmSession::reopen() {
  const auto found = devices::find_device(parts_.buses, {arm_.device});
  if (!found) return {};  // unplugged, which the state says already
  const std::string refusal = "arm '" + arm_.name + "' is back but cannot be opened";
  const Result<void> is_same = devices::check_same_device(identity_, *found);
  if (!is_same) return tl::unexpected(is_same.error().in(refusal));
  Result<std::unique_ptr<HapticDevice>> device = open_device(arm_, parts_);
  if (!device) return tl::unexpected(device.error().in(refusal));
  const Result<void> is_alike =
      devices::check_same_limits(device_.capabilities(), (*device)->capabilities());
  if (!is_alike) return tl::unexpected(is_alike.error().in(refusal));
  Result<void> guarded = guard_.begin(**device);
  if (!guarded) return guarded;
  (*device)->forget_calibration();
  if (!device_.offer(*device)) return fail(Errc::Busy, "arm '" + arm_.name + "' is being replaced");
  offered_at_tick_ = snapshot().frame.tick;
  return {};
}

}  // namespace thimble::session
