#include "drivers/falcon/falcon_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thimble::falcon {
namespace {

// An exchange takes 1.3 ms, so a servo of 1 kHz has a reply in every second tick.
constexpr Duration kExchange = 2 * wire::kFramePeriod;

// Ours: so many points of the workspace's surface, evenly, where a newton asks for more than within
// (checked by a test).
constexpr int kSurfacePoints = 400;
constexpr double kBetweenPoints = 1.01;  // ours: what may lie between them

std::array<double, 3> most_share_per_newton(const FalconModel& model,
                                            const FalconKinematics& kinematics) {
  std::array<double, 3> most{};
  for (int i = 0; i < kSurfacePoints; ++i) {
    const double height = 1 - (2 * i + 1.0) / kSurfacePoints;
    const double around_rad = i * std::numbers::pi * (3 - std::sqrt(5.0));  // golden angle
    const double out_m = model.workspace_radius_m * std::sqrt(1 - height * height);
    const Position3 tip{out_m * std::cos(around_rad), out_m * std::sin(around_rad),
                        model.workspace_radius_m * height};
    ArmPose pose;
    if (kinematics.inverse(tip, pose.crank_rad) != PoseTrouble::None) continue;
    if (kinematics.forward(pose.crank_rad, tip, pose) != PoseTrouble::None) continue;
    for (std::size_t motor = 0; motor < most.size(); ++motor) {
      const auto& row = pose.command_per_force.row[motor];
      most[motor] = std::max(most[motor], norm(row[0], row[1], row[2]) / wire::kMaxMotor_counts);
    }
  }
  for (double& share : most) share *= kBetweenPoints;
  return most;
}

HapticCapabilities capabilities_of(const FalconModel& model, const FalconKinematics& kinematics) {
  HapticCapabilities capabilities;
  capabilities.model = model.name;
  capabilities.joint_count = kFirstGimbalJoint;
  capabilities.peak_force_newton = model.peak_force_newton;
  capabilities.continuous_force_newton = model.continuous_force_newton;
  capabilities.max_stiffness_newton_per_m = model.max_stiffness_newton_per_m;
  capabilities.workspace_radius_m = model.workspace_radius_m;
  capabilities.peak_current_a.fill(1);
  capabilities.continuous_current_a.fill(model.continuous_share);
  capabilities.most_current_a_per_newton = most_share_per_newton(model, kinematics);
  capabilities.sample_period = kExchange;
  capabilities.full_rate_hz = kFullRate_hz;
  capabilities.device_watchdog = wire::kWatchdog;
  return capabilities;
}

ArmPose middle_of(const FalconKinematics& kinematics) {
  ArmPose pose;
  CrankAngles crank_rad{};
  if (kinematics.inverse({}, crank_rad) != PoseTrouble::None) return pose;
  static_cast<void>(kinematics.forward(crank_rad, {}, pose));
  return pose;
}

std::string_view advice_for(BootTrouble trouble) noexcept {
  switch (trouble) {
    case BootTrouble::None:
      return "Wait while the Falcon's firmware is looked for and uploaded";
    case BootTrouble::NoImage:
      return "The Falcon has no firmware, and arm.firmware names none: docs/first-arm.md says "
             "where to get it";
    case BootTrouble::NoLoader:
      return "The Falcon's boot-loader does not answer: plug in its power supply, then its USB "
             "cable once more";
    case BootTrouble::EchoMissing:
      return "The upload to the Falcon breaks off; it is tried again, but a powered USB 2 hub or "
             "another port may help";
    case BootTrouble::EchoWrong:
      return "The Falcon got another firmware than was sent; it is tried again, but a shorter "
             "cable or another port may help";
    case BootTrouble::NotStarted:
      return "The Falcon took the firmware but does not run it: is arm.firmware the right file?";
    case BootTrouble::RequestRefused:
      return "The Falcon's USB bridge refused a request: plug its USB cable once more";
  }
  return {};
}

// The state's bits: the button in the middle of the grip is that of other arms' stylus.
std::uint32_t buttons_of(std::uint8_t wire_buttons) noexcept {
  constexpr std::array<std::uint8_t, 4> kInOrder{wire::kButtonCentre, wire::kButtonLeft,
                                                 wire::kButtonForward, wire::kButtonRight};
  std::uint32_t buttons = 0;
  for (std::size_t i = 0; i < kInOrder.size(); ++i) {
    if ((wire_buttons & kInOrder[i]) != 0) buttons |= 1U << i;
  }
  return buttons;
}

}  // namespace

FalconDevice::FalconDevice(std::unique_ptr<bus::UsbDevice> bus, const FalconModel& model,
                           Settings settings)
    : bus_(std::move(bus)),
      clock_(settings.clock),
      image_(std::move(settings.image)),
      kinematics_(model, settings.newton_per_count),
      capabilities_(capabilities_of(model, kinematics_)),
      boot_(image_),
      reference_(model),
      middle_(middle_of(kinematics_)),
      pose_(middle_) {}

// The arm has no watchdog that anybody knows of.
FalconDevice::~FalconDevice() {
  if (!boot_.is_running()) return;
  static_cast<void>(bus_->submit(wire::kBulkOut, encode_run_command({})));
}

const HapticCapabilities& FalconDevice::capabilities() const noexcept { return capabilities_; }

std::string_view FalconDevice::calibration_instruction() const noexcept {
  if (calibration_.load(std::memory_order_relaxed) == CalibrationState::Ok) return {};
  if (!has_heard_.load(std::memory_order_relaxed)) {
    return "Wait for the first packet of the Falcon; when none comes, check its cable";
  }
  if (stage_.load(std::memory_order_relaxed) != BootStage::Running) {
    return advice_for(trouble_.load(std::memory_order_relaxed));
  }
  return "Pull the Falcon's grip fully out and push it fully in, until it is calibrated";
}

// Dark, and motors at rest; to a boot-loader these bytes are noise.
std::optional<ZeroCommand> FalconDevice::zero_command() const noexcept {
  ZeroCommand zero{.endpoint = wire::kBulkOut};
  for (const std::uint8_t byte : encode_run_command({})) zero.bytes.push_back(byte);
  return zero;
}

DeviceCounters FalconDevice::counters() const noexcept {
  const bus::UsbCounters out = bus_->counters(wire::kBulkOut);
  DeviceCounters counters;
  counters.reports_in = reports_.load(std::memory_order_relaxed);
  counters.reports_skipped = skipped_.load(std::memory_order_relaxed);
  counters.malformed = malformed_.load(std::memory_order_relaxed);
  counters.commands_out = out.packets_out;
  counters.commands_superseded = out.writes_superseded;
  return counters;
}

void FalconDevice::forget_calibration() noexcept {
  reference_.forget();
  pose_ = middle_;
  publish();
}

void FalconDevice::start_over() noexcept {
  boot_.restart();
  parser_.forget();
  pacer_.restart();
  sent_counts_ = {};
  forget_calibration();
}

void FalconDevice::publish() noexcept {
  stage_.store(boot_.stage(), std::memory_order_relaxed);
  trouble_.store(boot_.trouble(), std::memory_order_relaxed);
  calibration_.store(reference_.state(), std::memory_order_relaxed);
}

IoStatus FalconDevice::read(HapticState& out) noexcept {
  fresh_.reset();
  const IoStatus taken = take_packets();
  pass_silence();
  is_given_up_ = is_given_up_ || boot_.is_stuck();
  if (taken == IoStatus::Disconnected || is_given_up_) {
    start_over();
    return IoStatus::Disconnected;
  }
  if (boot_.is_running() && pacer_.is_deserted(now_)) {
    start_over();
    boot_.find_again();
  }
  if (fresh_ && reference_.is_known() && !take_pose(*fresh_)) lose_reference();
  publish();
  const bool is_disturbed = parser_.lost_bytes() != lost_bytes_seen_;
  lost_bytes_seen_ = parser_.lost_bytes();
  if (is_disturbed || is_loss_untold_) malformed_.fetch_add(1, std::memory_order_relaxed);
  if (!fresh_) return is_disturbed ? IoStatus::ProtocolError : IoStatus::NoData;
  fill(out, *fresh_);
  return IoStatus::Ok;
}

// No more packets than the queue holds: a device that floods it does not hold the tick.
IoStatus FalconDevice::take_packets() noexcept {
  bus::UsbControlReply reply;
  const IoStatus control = bus_->read_control(reply);
  if (control == IoStatus::Disconnected) return control;
  if (control == IoStatus::Ok) boot_.on_request_end(reply.outcome);
  for (std::size_t i = 0; i < bus::kUsbQueuedPackets; ++i) {
    const IoStatus status = bus_->read(wire::kBulkIn, packet_);
    if (status != IoStatus::Ok) return status;
    has_heard_.store(true, std::memory_order_relaxed);
    heard_at_ = now_ = std::max(now_, packet_.arrived_at);
    const auto serial = serial_bytes(packet_.payload());
    if (boot_.is_running()) {
      take_run_bytes(serial);
    } else {
      boot_.on_packet(serial, now_);
    }
  }
  return IoStatus::Ok;
}

// A pipe on which nothing comes at all must not make time stand still: the motors may hold a force.
void FalconDevice::pass_silence() noexcept {
  if (clock_ == nullptr) return;
  const MonotonicTime now = clock_->now();
  if (!heard_at_) heard_at_ = now;
  if (now - *heard_at_ <= kSilentPipe) return;
  now_ = std::max(now_, now);
  if (!boot_.is_running()) boot_.on_packet({}, now_);
}

void FalconDevice::take_run_bytes(std::span<const std::uint8_t> serial) noexcept {
  for (const std::uint8_t byte : serial) {
    const auto report = parser_.take(byte);
    if (!report) continue;
    pacer_.on_reply(now_);
    if (fresh_) skipped_.fetch_add(1, std::memory_order_relaxed);
    reports_.fetch_add(1, std::memory_order_relaxed);
    fresh_ = *report;
    if (!reference_.on_report(*report, now_ - reported_at_)) lose_reference();
    reported_at_ = now_;
  }
}

void FalconDevice::lose_reference() noexcept {
  reference_.forget();
  pose_ = middle_;
  is_loss_untold_ = true;
}

bool FalconDevice::take_pose(const RunReport& report) noexcept {
  const CrankAngles crank_rad = kinematics_.crank_angles(report.encoder_counts);
  if (kinematics_.is_beyond_stops(crank_rad, kStopSlack_rad)) return false;
  if (kinematics_.forward(crank_rad, pose_.tip, pose_) == PoseTrouble::None) return true;
  return kinematics_.forward(crank_rad, middle_.tip, pose_) == PoseTrouble::None;
}

void FalconDevice::fill(HapticState& out, const RunReport& report) noexcept {
  out.sampled_at = reported_at_;
  out.sample_sequence = reports_.load(std::memory_order_relaxed);
  const ArmPose& pose = reference_.is_known() ? pose_ : middle_;
  out.joint_position_rad = {pose.crank_rad[0], pose.crank_rad[1], pose.crank_rad[2]};
  out.tip = pose.tip;
  for (std::size_t motor = 0; motor < 3; ++motor) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out.motor_current_per_force.row[motor][axis] =
          pose.command_per_force.row[motor][axis] / wire::kMaxMotor_counts;
    }
  }
  out.buttons = buttons_of(report.buttons);
  out.calibration = is_loss_untold_ ? CalibrationState::NeedsUser : reference_.state();
  is_loss_untold_ = false;
}

IoStatus FalconDevice::write(const LimitedWrench& wrench) noexcept { return drive(wrench.force()); }

IoStatus FalconDevice::drive(Force3 force) noexcept {
  if (is_given_up_) return IoStatus::Disconnected;
  if (!boot_.is_running()) return carry_out(boot_.next());
  RunCommand command;
  command.motor_counts = motors_for(force);
  const bool is_zero = command.motor_counts == MotorCounts{};
  const bool takes_force_away = is_zero && sent_counts_ != MotorCounts{};
  if (!takes_force_away && !pacer_.may_send(now_)) return IoStatus::Backlogged;
  const bool is_homed = reference_.is_known();
  command.is_homing = !is_homed;
  command.lights = {.is_red = !is_homed, .is_green = is_homed, .is_blue = !is_zero};
  const IoStatus status = bus_->submit(wire::kBulkOut, encode_run_command(command));
  if (status != IoStatus::Ok && status != IoStatus::Backlogged) return status;
  sent_counts_ = command.motor_counts;
  pacer_.on_sent(now_);
  return status;
}

IoStatus FalconDevice::carry_out(const BootOrder& order) noexcept {
  IoStatus status = IoStatus::Ok;
  if (order.kind == BootOrder::Kind::Request) status = bus_->start_control(order.request);
  if (order.kind == BootOrder::Kind::Packet) status = bus_->submit(wire::kBulkOut, order.packet());
  return status == IoStatus::Disconnected ? status : IoStatus::Backlogged;
}

// The limiter has kept the commands in range already; this is the last line. Scaling all three
// alike keeps the direction of the force.
FalconDevice::MotorCounts FalconDevice::motors_for(Force3 force) const noexcept {
  if (!reference_.is_known() || !is_finite(force)) return {};
  std::array<double, 3> wanted_counts{};
  double largest_counts = wire::kMaxMotor_counts;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = pose_.command_per_force.row[i];
    wanted_counts[i] = row[0] * force.x + row[1] * force.y + row[2] * force.z;
    if (!std::isfinite(wanted_counts[i])) return {};
    largest_counts = std::max(largest_counts, std::abs(wanted_counts[i]));
  }
  MotorCounts counts{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double scaled_counts = wanted_counts[i] * (wire::kMaxMotor_counts / largest_counts);
    counts[i] = static_cast<std::int16_t>(std::lround(scaled_counts));
  }
  return counts;
}

}  // namespace thimble::falcon
