#include "drivers/phantom/phantom_device.hpp"

#include <algorithm>
#include <cmath>

namespace thimble::phantom {
namespace {

constexpr std::string_view kNoReportYet =
    "Wait for the first report of the controller; when none comes, check its power and cable";

bool has_gimbal(const PhantomModel& model) noexcept {
  return std::any_of(model.gimbal_counts_per_rev.begin(), model.gimbal_counts_per_rev.end(),
                     [](double counts) { return counts > 0; });
}

HapticCapabilities capabilities_of(const PhantomModel& model, double amplifier_max_a,
                                   Duration watchdog) {
  HapticCapabilities capabilities;
  capabilities.model = model.name;
  capabilities.joint_count = has_gimbal(model) ? kMaxJoints : kFirstGimbalJoint;
  capabilities.peak_force_newton = model.peak_force_newton;
  capabilities.continuous_force_newton = model.continuous_force_newton;
  capabilities.max_stiffness_newton_per_m = model.max_stiffness_newton_per_m;
  capabilities.workspace_radius_m = model.workspace_radius_m;
  for (std::size_t i = 0; i < 3; ++i) {
    capabilities.peak_current_a[i] = std::min(amplifier_max_a, model.peak_current_a[i]);
    capabilities.continuous_current_a[i] = std::min(amplifier_max_a, model.continuous_current_a[i]);
  }
  capabilities.sample_period = wire::kSamplePeriod;
  capabilities.device_watchdog = watchdog;
  return capabilities;
}

}  // namespace

PhantomDevice::PhantomDevice(std::unique_ptr<ControllerLink> link, const PhantomModel& model,
                             double amplifier_max_a)
    : link_(std::move(link)),
      model_(model),
      capabilities_(capabilities_of(model, amplifier_max_a, link_->watchdog())),
      home_instruction_("Hold the arm in " + std::string(model.home_pose) +
                        " and press the calibration button on the controller"),
      // A press elsewhere would make that place the home pose, so only the power helps there.
      unseen_instruction_(
          "Move the arm away from where it stands now, for here a press would not be seen. " +
          home_instruction_ +
          "; if it stood in that pose already, switch the controller off and on while it is away"),
      tracker_(model),
      pose_(pose_at(model, model.home_angle_rad)) {}

PhantomDevice::~PhantomDevice() { static_cast<void>(link_->write_currents({})); }

const HapticCapabilities& PhantomDevice::capabilities() const noexcept { return capabilities_; }

std::string_view PhantomDevice::calibration_instruction() const noexcept {
  if (const std::string_view trouble = link_->trouble(); !trouble.empty()) return trouble;
  switch (calibration_.load(std::memory_order_relaxed)) {
    case CalibrationState::Unknown:
      return kNoReportYet;
    case CalibrationState::NeedsUser:
      return link_->is_press_unseen() ? unseen_instruction_ : home_instruction_;
    case CalibrationState::Ok:
      return {};
  }
  return {};
}

std::optional<ZeroCommand> PhantomDevice::zero_command() const noexcept {
  return link_->zero_command();
}

DeviceCounters PhantomDevice::counters() const noexcept {
  DeviceCounters counters = link_->counters();
  counters.malformed += malformed_.load(std::memory_order_relaxed);
  return counters;
}

void PhantomDevice::forget_calibration() noexcept {
  homing_.forget();
  pose_ = pose_at(model_, model_.home_angle_rad);
  publish_calibration();
}

IoStatus PhantomDevice::read(HapticState& out) noexcept {
  const IoStatus status = link_->read(report_);
  if (status == IoStatus::Disconnected) forget_calibration();
  if (status != IoStatus::Ok) return status;
  const Arrival arrival{report_.arrived_at, report_.sequence};
  const IoStatus taken = take(report_.values, arrival);
  last_ = arrival;
  has_last_ = true;
  if (taken != IoStatus::Ok) return taken;

  out.sampled_at = arrival.at;
  out.sample_sequence = arrival.sequence;
  out.joint_position_rad = joint_angle_rad(report_.values);
  out.tip = pose_.tip;
  out.motor_current_per_force = pose_.motor_current_per_force;
  out.buttons = report_.values.is_stylus_pressed ? 1U : 0U;
  out.calibration = homing_.state();
  return IoStatus::Ok;
}

std::array<double, kMaxJoints> PhantomDevice::joint_angle_rad(
    const DeviceReport& report) const noexcept {
  std::array<double, kMaxJoints> all{pose_.angle_rad[0], pose_.angle_rad[1], pose_.angle_rad[2]};
  if (homing_.state() != CalibrationState::Ok) return all;
  const std::array<double, 3> gimbal_rad = gimbal_angle_rad(model_, report.gimbal_counts);
  std::copy(gimbal_rad.begin(), gimbal_rad.end(), all.begin() + kFirstGimbalJoint);
  return all;
}

IoStatus PhantomDevice::take(const DeviceReport& report, const Arrival& arrival) noexcept {
  const Duration elapsed = since_last(arrival);
  // While a controller was silent it may have been reset, or its button pressed: its counters are
  // then zero somewhere, and nothing tells.
  if (elapsed > capabilities_.device_watchdog) forget_calibration();
  const bool was_calibrated = homing_.state() == CalibrationState::Ok;
  const bool is_zeroed = link_->is_zeroed_by_press() && report.is_calibration_pressed;
  if (was_calibrated && (is_zeroed || !tracker_.follow(report.base_counts, elapsed))) {
    forget_calibration();
    return count_malformed();
  }
  homing_.on_report(report, elapsed);
  if (homing_.state() == CalibrationState::Ok) {
    if (!was_calibrated) tracker_.restart(report.base_counts);
    pose_ = pose_at(model_, body_angles(model_, tracker_.counts()));
  }
  publish_calibration();
  return IoStatus::Ok;
}

// Reports that came in one burst were still sampled a period apart.
Duration PhantomDevice::since_last(const Arrival& arrival) const noexcept {
  if (!has_last_) return {};
  const auto reports =
      static_cast<std::int64_t>(std::min<std::uint64_t>(arrival.sequence - last_.sequence, 1000));
  return std::max(arrival.at - last_.at, reports * wire::kSamplePeriod);
}

IoStatus PhantomDevice::write(const LimitedWrench& wrench) noexcept {
  if (homing_.wants_zero_counters()) return link_->zero_counters();
  return link_->write_currents(currents_for(wrench.force()));
}

// The limiter has kept the currents in range already; this is the last line. Scaling all
// three alike keeps the direction of the force.
std::array<double, 3> PhantomDevice::currents_for(Force3 force) const noexcept {
  if (homing_.state() != CalibrationState::Ok || !is_finite(force)) return {};
  std::array<double, 3> current_a{};
  double scale = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = pose_.motor_current_per_force.row[i];
    current_a[i] = row[0] * force.x + row[1] * force.y + row[2] * force.z;
    const double size_a = std::abs(current_a[i]);
    if (!std::isfinite(size_a)) return {};
    const double limit_a = capabilities_.peak_current_a[i];
    if (size_a > limit_a) scale = std::min(scale, limit_a / size_a);
  }
  for (double& current : current_a) current *= scale;
  return current_a;
}

void PhantomDevice::publish_calibration() noexcept {
  calibration_.store(homing_.state(), std::memory_order_relaxed);
}

IoStatus PhantomDevice::count_malformed() noexcept {
  malformed_.fetch_add(1, std::memory_order_relaxed);
  return IoStatus::ProtocolError;
}

}  // namespace thimble::phantom
