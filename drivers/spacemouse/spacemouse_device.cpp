#include "drivers/spacemouse/spacemouse_device.hpp"

#include "drivers/spacemouse/spacemouse_codec.hpp"

namespace thimble::spacemouse {
namespace {

HapticCapabilities capabilities_of(const SpaceMouseModel& model) {
  HapticCapabilities capabilities;
  capabilities.model = model.name;
  capabilities.joint_count = kFirstGimbalJoint;
  capabilities.is_actuated = false;
  capabilities.workspace_radius_m = Pointer::kRadius_m;
  // Ours: what a servo of 1 kHz reads; the point moves between the puck's reports, too.
  capabilities.sample_period = std::chrono::milliseconds(1);
  return capabilities;
}

}  // namespace

SpaceMouseDevice::SpaceMouseDevice(std::unique_ptr<bus::HidDevice> bus,
                                   const SpaceMouseModel& model, const Clock& clock)
    : bus_(std::move(bus)),
      clock_(clock),
      capabilities_(capabilities_of(model)),
      pointer_(model.full_deflection_counts) {}

std::string_view SpaceMouseDevice::calibration_instruction() const noexcept {
  if (calibration_.load(std::memory_order_relaxed) == CalibrationState::Ok) return {};
  return "Let go of the puck for a moment: where it rests is its centre";
}

DeviceCounters SpaceMouseDevice::counters() const noexcept {
  const bus::HidCounters on_bus = bus_->counters();
  DeviceCounters counters;
  counters.reports_in = on_bus.reports_in;
  counters.reports_skipped = on_bus.reports_skipped;
  counters.malformed = malformed_.load(std::memory_order_relaxed);
  return counters;
}

void SpaceMouseDevice::forget_calibration() noexcept {
  pointer_.forget();
  buttons_ = 0;
  publish_calibration();
}

IoStatus SpaceMouseDevice::read(HapticState& out) noexcept {
  const IoStatus status = bus_->read_newest(report_);
  if (status == IoStatus::Disconnected) {
    is_connected_ = false;
    forget_calibration();
    return status;
  }
  const bool is_sound = status != IoStatus::Ok || take(report_);
  pointer_.advance(clock_.now());
  publish_calibration();
  if (!is_sound) {
    malformed_.fetch_add(1, std::memory_order_relaxed);
    return IoStatus::ProtocolError;
  }
  out = {};
  out.sampled_at = clock_.now();
  out.sample_sequence = ++samples_;
  out.tip = pointer_.position();
  out.buttons = buttons_;
  out.calibration = pointer_.calibration();
  return IoStatus::Ok;
}

bool SpaceMouseDevice::take(const bus::HidReport& report) noexcept {
  const std::optional<PuckReport> said = parse_report(report.payload());
  if (!said) return false;
  if (said->translation) pointer_.push(*said->translation, report.arrived_at);
  if (said->rotation) pointer_.turn(*said->rotation, report.arrived_at);
  if (said->buttons) buttons_ = *said->buttons;
  return true;
}

IoStatus SpaceMouseDevice::write(const LimitedWrench& wrench) noexcept {
  static_cast<void>(wrench);
  return is_connected_ ? IoStatus::Ok : IoStatus::Disconnected;
}

void SpaceMouseDevice::publish_calibration() noexcept {
  calibration_.store(pointer_.calibration(), std::memory_order_relaxed);
}

}  // namespace thimble::spacemouse
