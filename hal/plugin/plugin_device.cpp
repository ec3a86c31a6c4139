#include "hal/plugin/plugin_device.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "hal/plugin/plugin_check.hpp"
#include "hal/plugin/sample_state.hpp"

namespace thimble::plugin {
namespace {

static_assert(THIMBLE_REPORT_BYTES == bus::kMaxHidReportBytes);

constexpr std::string_view kNoReportYet =
    "Wait for the first report of the arm; when none comes, check its power and cable";

}  // namespace

PluginDevice::PluginDevice(Parts parts, HapticCapabilities capabilities, std::string instruction)
    : parts_(std::move(parts)),
      capabilities_(std::move(capabilities)),
      instruction_(instruction.empty() ? "Calibrate the arm as its maker says"
                                       : std::move(instruction)),
      zero_(ask_for_zero()) {}

PluginDevice::~PluginDevice() {
  static_cast<void>(write(LimitedWrench::zero()));
  parts_.driver->close(parts_.device);
}

const HapticCapabilities& PluginDevice::capabilities() const noexcept { return capabilities_; }

std::string_view PluginDevice::calibration_instruction() const noexcept {
  switch (calibration_.load(std::memory_order_relaxed)) {
    case CalibrationState::Unknown:
      return kNoReportYet;
    case CalibrationState::NeedsUser:
      return instruction_;
    case CalibrationState::Ok:
      return {};
  }
  return {};
}

std::optional<ZeroCommand> PluginDevice::zero_command() const noexcept { return zero_; }

// What the plugin sends for no force before it has heard of the arm must do at any time.
std::optional<ZeroCommand> PluginDevice::ask_for_zero() noexcept {
  const thimble_wrench nothing{sizeof(thimble_wrench), 0, {0, 0, 0}};
  std::array<std::uint8_t, THIMBLE_REPORT_BYTES> bytes{};
  if (parts_.driver->encode(parts_.device, &nothing, bytes.data()) != THIMBLE_OK) return {};
  ZeroCommand zero;
  for (std::size_t i = 0; i < parts_.output_report_bytes; ++i) zero.bytes.push_back(bytes[i]);
  return zero;
}

DeviceCounters PluginDevice::counters() const noexcept {
  const bus::HidCounters on_bus = parts_.bus->counters();
  return {.reports_in = on_bus.reports_in,
          .reports_skipped = on_bus.reports_skipped,
          .malformed = malformed_.load(std::memory_order_relaxed),
          .commands_out = on_bus.reports_out,
          .commands_superseded = on_bus.writes_superseded};
}

void PluginDevice::forget_calibration() noexcept {
  calibration_.store(CalibrationState::Unknown, std::memory_order_relaxed);
  is_done_doubted_ = true;
  parts_.driver->forget_calibration(parts_.device);
}

IoStatus PluginDevice::read(HapticState& out) noexcept {
  const IoStatus status = parts_.bus->read_newest(report_);
  if (status == IoStatus::Disconnected) forget_calibration();
  if (status != IoStatus::Ok) return status;
  thimble_hid_report report{};
  report.struct_bytes = sizeof(report);
  report.size = static_cast<std::uint32_t>(report_.size);
  report.arrived_at_ns = report_.arrived_at.since_epoch.count();
  report.sequence = report_.sequence;
  std::copy_n(report_.bytes.begin(), report_.size, report.bytes);
  thimble_sample sample{};
  sample.struct_bytes = sizeof(sample);
  const std::int32_t decoded = parts_.driver->decode(parts_.device, &report, &sample);
  if (decoded == THIMBLE_NO_DATA) return IoStatus::NoData;
  if (decoded != THIMBLE_OK) return count_malformed();
  if (!is_sound(sample)) {
    forget_calibration();
    return count_malformed();
  }
  doubt_calibration(sample, is_done_doubted_);
  copy_sample(sample, capabilities_.joint_count, out);
  out.sampled_at = report_.arrived_at;
  out.sample_sequence = report_.sequence;
  calibration_.store(out.calibration, std::memory_order_relaxed);
  return IoStatus::Ok;
}

IoStatus PluginDevice::write(const LimitedWrench& wrench) noexcept {
  const bool is_calibrated = calibration_.load(std::memory_order_relaxed) == CalibrationState::Ok;
  const Force3 force = is_calibrated ? wrench.force() : Force3{};
  const thimble_wrench limited{sizeof(thimble_wrench), 0, {force.x, force.y, force.z}};
  std::array<std::uint8_t, THIMBLE_REPORT_BYTES> bytes{};
  const std::int32_t encoded = parts_.driver->encode(parts_.device, &limited, bytes.data());
  if (encoded != THIMBLE_OK) return count_malformed();
  return parts_.bus->submit({bytes.data(), parts_.output_report_bytes});
}

IoStatus PluginDevice::count_malformed() noexcept {
  malformed_.fetch_add(1, std::memory_order_relaxed);
  return IoStatus::ProtocolError;
}

}  // namespace thimble::plugin
