// The Falcon's driver as a shared object: the same code, behind the ABI for drivers from outside.
#include <algorithm>
#include <memory>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/falcon/falcon_device.hpp"
#include "drivers/falcon/falcon_match.hpp"
#include "drivers/falcon/falcon_wire.hpp"
#include "drivers/falcon/firmware_image.hpp"
#include "hal/plugin/abi_status.hpp"
#include "hal/plugin/plugin_abi.h"

namespace thimble::falcon {

// What the boundary may ask of a device, and a program may not: a force without its limiter.
class HostedFalcon {
 public:
  static IoStatus write(FalconDevice& arm, const thimble_wrench& limited) noexcept {
    return arm.drive({limited.force_newton[0], limited.force_newton[1], limited.force_newton[2]});
  }
};

namespace {

// The host's pipes, as a driver of the house knows them.
class HostPipes final : public bus::UsbDevice {
 public:
  explicit HostPipes(const thimble_usb_bus& host) noexcept : host_(&host) {}

  IoStatus read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept override {
    thimble_usb_packet packet{};
    const IoStatus status = plugin::io_status(host_->read(host_->context, endpoint, &packet));
    if (status != IoStatus::Ok) return status;
    out.size = std::min<std::size_t>(packet.size, out.bytes.size());
    std::copy_n(packet.bytes, out.size, out.bytes.begin());
    out.arrived_at = {Duration(packet.arrived_at_ns)};
    out.sequence = packet.sequence;
    return status;
  }
  IoStatus submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept override {
    const auto size = static_cast<std::uint32_t>(packet.size());
    return plugin::io_status(host_->submit(host_->context, endpoint, packet.data(), size));
  }
  IoStatus start_control(const bus::UsbControlRequest& request) noexcept override {
    thimble_usb_request said{sizeof(thimble_usb_request),
                             request.request_type,
                             request.request,
                             request.value,
                             request.index,
                             request.length,
                             {}};
    std::copy(request.data.begin(), request.data.end(), said.data);
    return plugin::io_status(host_->start_control(host_->context, &said));
  }
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    thimble_usb_reply reply{};
    const IoStatus status = plugin::io_status(host_->read_control(host_->context, &reply));
    if (status != IoStatus::Ok) return status;
    out.outcome = static_cast<bus::UsbOutcome>(reply.outcome);
    out.size = std::min<std::size_t>(reply.size, out.data.size());
    std::copy_n(reply.data, out.size, out.data.begin());
    return status;
  }
  // The host counts what crosses its pipes.
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t) const noexcept override { return {}; }

 private:
  const thimble_usb_bus* host_;
};

template <std::size_t Bytes>
void put(std::string_view text, char (&out)[Bytes]) noexcept {
  const std::size_t size = std::min(text.size(), Bytes - 1);
  std::fill(std::copy_n(text.begin(), size, out), out + Bytes, '\0');
}

bus::BusDeviceInfo info_of(const thimble_usb_info& said) {
  bus::BusDeviceInfo info;
  info.address = {said.address};
  info.kind = bus::BusKind::Usb;
  info.vendor_id = said.vendor_id;
  info.product_id = said.product_id;
  for (std::uint32_t i = 0; i < said.endpoint_count; ++i) {
    const thimble_usb_endpoint& endpoint = said.endpoints[i];
    info.endpoints.push_back({endpoint.interface_number, endpoint.address,
                              static_cast<bus::UsbTransferKind>(endpoint.kind),
                              endpoint.max_packet_bytes, 0});
  }
  return info;
}

plugin::DriverSettings settings_of(const thimble_usb_settings& said) {
  plugin::DriverSettings settings;
  settings.model = said.model;
  settings.firmware = said.firmware;
  settings.firmware_sha256 = said.sha256;
  if (said.newton_per_count != 0) settings.newton_per_count = said.newton_per_count;
  return settings;
}

std::int32_t refuse(const Error& error, thimble_reason& reason) {
  put(error.message, reason.text);
  return error.code == Errc::NotMine ? THIMBLE_NOT_MINE : THIMBLE_REFUSED;
}

std::int32_t match_arm(const thimble_usb_info* info, const thimble_usb_settings* settings,
                       thimble_reason* reason) {
  const auto found = match(info_of(*info), settings_of(*settings));
  return found ? THIMBLE_OK : refuse(found.error(), *reason);
}

void tell(const HapticCapabilities& arm, thimble_capabilities& out) {
  out.joint_count = static_cast<std::uint32_t>(arm.joint_count);
  put(arm.model, out.model);
  out.peak_force_newton = arm.peak_force_newton;
  out.continuous_force_newton = arm.continuous_force_newton;
  out.max_stiffness_newton_per_m = arm.max_stiffness_newton_per_m;
  out.workspace_radius_m = arm.workspace_radius_m;
  std::copy(arm.peak_current_a.begin(), arm.peak_current_a.end(), out.peak_current_a);
  std::copy(arm.continuous_current_a.begin(), arm.continuous_current_a.end(),
            out.continuous_current_a);
  std::copy(arm.most_current_a_per_newton.begin(), arm.most_current_a_per_newton.end(),
            out.most_current_a_per_newton);
  out.sample_period_ns = arm.sample_period.count();
  out.device_watchdog_ns = arm.device_watchdog.count();
  out.full_rate_hz = arm.full_rate_hz;
}

std::int32_t open_arm(const thimble_usb_info* info, const thimble_usb_settings* settings,
                      const thimble_usb_bus* bus, thimble_capabilities* capabilities,
                      thimble_usb_zero* zero, void** device, thimble_reason* reason) {
  const plugin::DriverSettings said = settings_of(*settings);
  const auto found = match(info_of(*info), said);
  if (!found) return refuse(found.error(), *reason);
  Result<std::vector<std::uint8_t>> image = std::vector<std::uint8_t>{};
  if (!said.firmware.empty()) image = load_image(said.firmware, said.firmware_sha256);
  if (!image) return refuse(image.error().in("falcon"), *reason);
  auto arm = std::make_unique<FalconDevice>(
      std::make_unique<HostPipes>(*bus), *found->model,
      FalconDevice::Settings{found->newton_per_count, *std::move(image)});
  tell(arm->capabilities(), *capabilities);
  if (const auto command = arm->zero_command()) {
    zero->endpoint = command->endpoint;
    zero->size = static_cast<std::uint32_t>(command->bytes.size());
    std::copy(command->bytes.begin(), command->bytes.end(), zero->bytes);
  }
  *device = arm.release();
  return THIMBLE_OK;
}

FalconDevice& arm_of(void* device) noexcept { return *static_cast<FalconDevice*>(device); }

void close_arm(void* device) { delete static_cast<FalconDevice*>(device); }
void forget(void* device) { arm_of(device).forget_calibration(); }

std::int32_t calibration_of(CalibrationState state) noexcept {
  switch (state) {
    case CalibrationState::Ok:
      return THIMBLE_CALIBRATION_DONE;
    case CalibrationState::NeedsUser:
      return THIMBLE_CALIBRATION_NEEDS_PERSON;
    case CalibrationState::Unknown:
      break;
  }
  return THIMBLE_CALIBRATION_UNKNOWN;
}

std::int32_t read_arm(void* device, thimble_usb_sample* sample) {
  HapticState state;
  const IoStatus status = arm_of(device).read(state);
  if (status != IoStatus::Ok) return plugin::abi_status(status);
  thimble_sample& out = sample->state;
  out.calibration = calibration_of(state.calibration);
  out.buttons = state.buttons;
  std::copy(state.joint_position_rad.begin(), state.joint_position_rad.end(),
            out.joint_position_rad);
  for (std::size_t i = 0; i < 3; ++i) out.tip_m[i] = state.tip[i];
  for (std::size_t motor = 0; motor < THIMBLE_MOTORS; ++motor) {
    const auto& row = state.motor_current_per_force.row[motor];
    std::copy(row.begin(), row.end(), out.motor_current_a_per_newton[motor]);
  }
  sample->sampled_at_ns = state.sampled_at.since_epoch.count();
  sample->sequence = state.sample_sequence;
  return THIMBLE_OK;
}

std::int32_t write_arm(void* device, const thimble_wrench* wrench) {
  return plugin::abi_status(HostedFalcon::write(arm_of(device), *wrench));
}

void read_instruction(void* device, thimble_reason* instruction) {
  put(arm_of(device).calibration_instruction(), instruction->text);
}

constexpr thimble_usb_driver kDriver{
    sizeof(thimble_usb_driver),
    0,
    "falcon",
    {wire::kInterface, 2, {{wire::kBulkIn, 1}, {wire::kBulkOut, 0}, {0, 0}, {0, 0}}},
    {},
    &match_arm,
    &open_arm,
    &close_arm,
    &forget,
    &read_arm,
    &write_arm,
    &read_instruction};

}  // namespace
}  // namespace thimble::falcon

THIMBLE_PLUGIN = {THIMBLE_PLUGIN_MAGIC,
                  THIMBLE_PLUGIN_ABI_VERSION,
                  THIMBLE_PLUGIN_ABI_REVISION,
                  sizeof(thimble_plugin),
                  nullptr,
                  nullptr,
                  0,
                  0,
                  &thimble::falcon::kDriver};
