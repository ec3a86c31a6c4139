#include "sim/model/falcon/falcon_arm_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "drivers/falcon/falcon_models.hpp"
#include "drivers/falcon/falcon_wire.hpp"

namespace thimble::sim {
namespace {

namespace wire = falcon::wire;

using plugin::UsbAnswer;
using plugin::UsbHandshake;

constexpr std::string_view kLostEcho = "lost-echo";
constexpr std::string_view kDeaf = "deaf";
constexpr std::string_view kShortReplies = "short-replies";
constexpr std::string_view kGluedReplies = "glued-replies";
constexpr std::string_view kLatency = "latency";

// Force along z at the origin, when all cranks have 1 N m.
double newton_per_newton_m(const FalconParameters& parameters) {
  DeltaPlant plant(parameters);
  const CrankVector& origin = parameters.origin_m;
  plant.rest_at({origin[0], origin[1], origin[2]});
  return plant.force_of({1, 1, 1}).z;
}

}  // namespace

FalconArmModel::FalconArmModel(const FalconParameters& parameters)
    : p_(parameters),
      plant_(parameters),
      newton_m_per_count_(parameters.newton_per_count / newton_per_newton_m(parameters)) {
  plant_.rest_at(to_device({p_.parked_m[0], p_.parked_m[1], p_.parked_m[2]}));
  counts_ = crank_counts();
  bridge_.power_up({});
  processor_.power_up();
}

bus::BusDeviceInfo FalconArmModel::describe() const {
  bus::BusDeviceInfo info;
  info.kind = bus::BusKind::Usb;
  info.vendor_id = wire::kVendorId;
  info.product_id = wire::kProductId;
  // Ours: no source tells the strings of a real arm; a simulated one says what it is.
  info.manufacturer = "Thimble";
  info.product = "Simulated arm " + std::string(falcon::kFalconModels[0].name);
  info.serial_number = "SIM-falcon";
  for (const std::uint8_t endpoint : {wire::kBulkIn, wire::kBulkOut}) {
    info.endpoints.push_back({wire::kInterface, endpoint, bus::UsbTransferKind::Bulk,
                              static_cast<std::uint16_t>(wire::kUsbPacketBytes), 0});
  }
  return info;
}

Triple FalconArmModel::to_device(Position3 tip) const noexcept {
  return {tip.x + p_.origin_m[0], tip.y + p_.origin_m[1], tip.z + p_.origin_m[2]};
}

Position3 FalconArmModel::to_base(const Triple& x) const noexcept {
  return {x.x - p_.origin_m[0], x.y - p_.origin_m[1], x.z - p_.origin_m[2]};
}

CrankCounts FalconArmModel::crank_counts() const noexcept {
  CrankCounts counts{};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double turned_rad = plant_.crank_rad()[i] - p_.home_rad;
    counts[i] = static_cast<std::int64_t>(std::floor(turned_rad * p_.counts_per_rad));
  }
  return counts;
}

Triple FalconArmModel::motor_torque() const noexcept {
  const std::array<int, 3> commands = processor_.motor_counts();
  Triple torque{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    torque[i] = p_.motor_sign[i] * newton_m_per_count_ * commands[i];
  }
  return torque;
}

Force3 FalconArmModel::force_of_load() noexcept {
  if (load_ == nullptr) return {};
  set_button(static_cast<unsigned>(FalconButton::Centre),
             is_centre_held_ || load_->is_button_pressed(plant_time_));
  const plugin::ArmTruth at = truth();
  const Force3 force = load_->force_on_tip(plant_time_, kSubstep, at.tip, at.tip_velocity);
  if (is_finite(force)) return force;
  ++non_finite_forces_;
  return {};
}

// The processor sees the cranks as they are when the substep begins; what it tells the motors in it
// acts from its end on.
void FalconArmModel::step() noexcept {
  const Force3 force = push_ + force_of_load();
  run_lines_until(plant_time_ + kSubstep);
  const Triple before = plant_.crank_rad();
  plant_.step(seconds(kSubstep), torque_, {force.x, force.y, force.z});
  plant_time_ = plant_time_ + kSubstep;
  counts_ = crank_counts();
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const bool is_inwards = before[i] > p_.home_rad && plant_.crank_rad()[i] <= p_.home_rad;
    if (is_inwards) processor_.firmware().pass_home(i);
  }
  torque_ = motor_torque();
}

void FalconArmModel::run_lines_until(MonotonicTime t) noexcept {
  while (true) {
    const MonotonicTime to_processor = bridge_.next_arrival();
    const MonotonicTime to_bridge = processor_.next_arrival();
    if (std::min(to_processor, to_bridge) > t) return;
    if (to_processor <= to_bridge) {
      processor_.receive(to_processor, bridge_.take_arrived(), counts_);
    } else {
      bridge_.receive(processor_.take_arrived());
    }
  }
}

void FalconArmModel::advance(MonotonicTime t) noexcept {
  if (!is_started_) {
    is_started_ = true;
    now_ = t;
    plant_time_ = t;
    bridge_.power_up(t);
  }
  if (t < now_) return;
  if (plant_time_ == now_) torque_ = motor_torque();  // told at the very start of the substep
  while (plant_time_ + kSubstep <= t) step();
  run_lines_until(t);
  now_ = t;
}

UsbAnswer FalconArmModel::control(const bus::UsbControlRequest& request,
                                  std::span<std::uint8_t> in) noexcept {
  const UsbAnswer answer = bridge_.control(now_, request, in);
  processor_.set_lines(now_, bridge_.is_dtr_high(), bridge_.is_rts_high());
  return answer;
}

UsbHandshake FalconArmModel::out_packet(std::uint8_t endpoint,
                                        std::span<const std::uint8_t> bytes) noexcept {
  if (endpoint != wire::kBulkOut) return UsbHandshake::Nak;
  return bridge_.out_packet(now_, bytes);
}

UsbAnswer FalconArmModel::in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept {
  if (endpoint != wire::kBulkIn) return {};
  return bridge_.in_packet(now_, out);
}

MonotonicTime FalconArmModel::unchanged_until() const noexcept {
  return bridge_.next_packet_at(processor_.most_to_arrive(bridge_.under_way()));
}

void FalconArmModel::power_cycle() noexcept {
  bridge_.power_up(now_);
  processor_.power_up();
}

void FalconArmModel::push_tip(Force3 force) noexcept {
  if (!is_finite(force)) {
    ++non_finite_forces_;
    force = {};
  }
  push_ = force;
}

bool FalconArmModel::move_tip_to(Position3 tip) noexcept {
  if (!is_finite(tip) || !plant_.rest_at(to_device(tip))) return false;
  counts_ = crank_counts();
  return true;
}

void FalconArmModel::press_stylus_button(bool pressed) noexcept {
  is_centre_held_ = pressed;
  press_button(FalconButton::Centre, pressed);
}

std::vector<plugin::ModelPanel::Reading> FalconArmModel::readings() const {
  return {{"uploads", static_cast<double>(processor_.counters().uploads)}};
}

void FalconArmModel::press_button(FalconButton button, bool pressed) noexcept {
  set_button(static_cast<unsigned>(button), pressed);
}

void FalconArmModel::set_button(unsigned bit, bool pressed) noexcept {
  buttons_ = pressed ? buttons_ | 1U << bit : buttons_ & ~(1U << bit);
  processor_.firmware().set_buttons(static_cast<std::uint8_t>(buttons_));
}

void FalconArmModel::set_faults(const FalconBootFaults& boot,
                                const FalconReplyFaults& replies) noexcept {
  processor_.set_faults(boot);
  processor_.firmware().set_faults(replies);
}

std::vector<plugin::ModelPanel::Fault> FalconArmModel::faults() const {
  const FalconBootFaults& boot = processor_.faults();
  const FalconReplyFaults& replies = processor_.firmware().faults();
  const Duration latency = bridge_.insisted_latency().value_or(Duration(0));
  const auto number = [](auto count) { return static_cast<std::uint32_t>(count); };
  return {{kLostEcho, number(boot.lost_echo ? *boot.lost_echo + 1 : 0)},
          {kDeaf, number(boot.deaf_questions)},
          {kShortReplies, number(replies.short_every)},
          {kGluedReplies, number(replies.glue_every)},
          {kLatency, number(latency / std::chrono::milliseconds(1))}};
}

bool FalconArmModel::set_fault(std::string_view name, std::uint32_t number) noexcept {
  constexpr std::uint32_t kMostLatency_ms = 255;  // a byte of the request
  FalconBootFaults boot = processor_.faults();
  FalconReplyFaults replies = processor_.firmware().faults();
  if (name == kLostEcho) {
    boot.lost_echo = number > 0 ? std::optional<std::size_t>(number - 1) : std::nullopt;
  } else if (name == kDeaf) {
    boot.deaf_questions = number;
  } else if (name == kShortReplies) {
    replies.short_every = number;
  } else if (name == kGluedReplies) {
    replies.glue_every = number;
  } else if (name == kLatency && number <= kMostLatency_ms) {
    const Duration latency = std::chrono::milliseconds(number);
    bridge_.insist_on_latency(number > 0 ? std::optional(latency) : std::nullopt);
  } else {
    return false;
  }
  set_faults(boot, replies);
  return true;
}

Position3 FalconArmModel::home_position() const noexcept {
  return {p_.pushed_in_m[0], p_.pushed_in_m[1], p_.pushed_in_m[2]};
}

Position3 FalconArmModel::calibration_start() const noexcept {
  return {p_.pulled_out_m[0], p_.pulled_out_m[1], p_.pulled_out_m[2]};
}

plugin::ArmTruth FalconArmModel::truth() const noexcept {
  plugin::ArmTruth truth;
  const Triple velocity = plant_.grip_velocity();
  const Triple force = plant_.force_of(motor_torque());
  truth.tip = to_base(plant_.grip());
  truth.tip_velocity = {velocity.x, velocity.y, velocity.z};
  truth.motor_force = {force.x, force.y, force.z};
  truth.mechanical_energy_j = plant_.mechanical_energy_j();
  truth.is_amplifier_on = processor_.state() == FalconProcessor::State::Running;
  return truth;
}

}  // namespace thimble::sim
