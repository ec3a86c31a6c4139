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

HapticCapabilities capabilities_of(const PhantomModel& model, double amplifier_max_a) {
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
  capabilities.device_watchdog = wire::kWatchdog;
  return capabilities;
}

}  // namespace

PhantomDevice::PhantomDevice(std::unique_ptr<bus::HidDevice> bus, const PhantomModel& model,
                             const Settings& settings)
    : bus_(std::move(bus)),
      model_(model),
      form_(settings.form),
      capabilities_(capabilities_of(model, settings.amplifier_max_a)),
      home_instruction_("Hold the arm in " + std::string(model.home_pose) +
                        " and press the calibration button on the controller"),
      tracker_(model),
      pose_(pose_at(model, model.home_angle_rad)) {}

PhantomDevice::~PhantomDevice() {
  const HostReport zero = encode_currents({}, form_);
  static_cast<void>(bus_->submit(zero.payload()));
}

const HapticCapabilities& PhantomDevice::capabilities() const noexcept { return capabilities_; }

std::string_view PhantomDevice::calibration_instruction() const noexcept {
  switch (calibration_.load(std::memory_order_relaxed)) {
    case CalibrationState::Unknown:
      return kNoReportYet;
    case CalibrationState::NeedsUser:
      return home_instruction_;
    case CalibrationState::Ok:
      return {};
  }
  return {};
}

std::optional<ZeroCommand> PhantomDevice::zero_command() const noexcept {
  ZeroCommand zero;
  const HostReport report = encode_currents({}, form_);
  for (const std::uint8_t byte : report.payload()) zero.bytes.push_back(byte);
  return zero;
}

DeviceCounters PhantomDevice::counters() const noexcept {
  const bus::HidCounters on_bus = bus_->counters();
  DeviceCounters counters;
  counters.reports_in = on_bus.reports_in;
  counters.reports_skipped = on_bus.reports_skipped;
  counters.malformed = malformed_.load(std::memory_order_relaxed);
  counters.commands_out = on_bus.reports_out;
  counters.commands_superseded = on_bus.writes_superseded;
  return counters;
}

void PhantomDevice::forget_calibration() noexcept {
  homing_.forget();
  pose_ = pose_at(model_, model_.home_angle_rad);
  publish_calibration();
}

IoStatus PhantomDevice::read(HapticState& out) noexcept {
  const IoStatus status = bus_->read_newest(report_);
  if (status == IoStatus::Disconnected) forget_calibration();
  if (status != IoStatus::Ok) return status;
  const auto parsed = parse_device_report(report_.payload(), form_);
  if (!parsed) return count_malformed();
  const Arrival arrival{report_.arrived_at, report_.sequence};
  const IoStatus taken = take(*parsed, arrival);
  last_ = arrival;
  has_last_ = true;
  if (taken != IoStatus::Ok) return taken;

  out.sampled_at = arrival.at;
  out.sample_sequence = arrival.sequence;
  out.joint_position_rad = joint_angle_rad(*parsed);
  out.tip = pose_.tip;
  out.motor_current_per_force = pose_.motor_current_per_force;
  out.buttons = parsed->is_stylus_pressed ? 1U : 0U;
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
  if (elapsed > wire::kWatchdog) forget_calibration();
  const bool was_calibrated = homing_.state() == CalibrationState::Ok;
  if (was_calibrated && !tracker_.follow(report.base_counts, elapsed)) {
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
  const HostReport report = homing_.wants_zero_counters()
                                ? encode_zero_counters(form_)
                                : encode_currents(currents_for(wrench.force()), form_);
  return bus_->submit(report.payload());
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
