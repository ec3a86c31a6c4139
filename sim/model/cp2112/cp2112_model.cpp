#include "sim/model/cp2112/cp2112_model.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace thimble::sim {
namespace {

using plugin::HidReportKind;

constexpr std::size_t kConfigBytes = 5;
constexpr std::size_t kGetBytes = 2;
constexpr std::size_t kSetBytes = 3;
constexpr std::size_t kVersionBytes = 3;
constexpr std::size_t kLockBytes = 2;
constexpr std::size_t kEndpointBytes = 64;  // of both interrupt endpoints: AN495, section 2
constexpr std::uint8_t kHardware = 2;       // device version, as chips that are sold have it

std::size_t fill(std::span<std::uint8_t> out, std::initializer_list<std::uint8_t> bytes) noexcept {
  if (out.size() < bytes.size()) return 0;
  std::copy(bytes.begin(), bytes.end(), out.begin());
  return bytes.size();
}

void describe_feature(std::vector<std::uint8_t>& out, std::uint8_t number, std::size_t bytes) {
  const auto data = static_cast<std::uint8_t>(bytes - 1);
  // HID 1.11, 6.2.2: report id, usage, so many bytes of 0 to 255, feature (data, variable).
  out.insert(out.end(), {0x85, number, 0x09, number, 0x95, data, 0xB1, 0x02});
}

}  // namespace

bus::BusDeviceInfo Cp2112Model::describe() const {
  bus::BusDeviceInfo info;
  info.address = {"sim:cp2112"};
  info.kind = bus::BusKind::Hid;
  info.vendor_id = kVendorId;
  info.product_id = kProductId;
  info.manufacturer = "Silicon Laboratories";
  info.product = "CP2112 HID USB-to-SMBus Bridge";
  info.serial_number = "SIM-CP2112";
  info.input_report_bytes = kEndpointBytes;
  info.output_report_bytes = kEndpointBytes;
  info.has_report_ids = true;
  return info;
}

Duration Cp2112Model::frame_period() const noexcept { return std::chrono::milliseconds(1); }

std::vector<std::uint8_t> Cp2112Model::report_descriptor() const {
  // A vendor's usage page and collection; all fields are bytes.
  std::vector<std::uint8_t> out{0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01,
                                0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08};
  describe_feature(out, kGpioConfig, kConfigBytes);
  describe_feature(out, kGetGpio, kGetBytes);
  describe_feature(out, kSetGpio, kSetBytes);
  describe_feature(out, kVersion, kVersionBytes);
  describe_feature(out, kSmbusConfig, kSmbusConfigBytes);
  describe_feature(out, kLockByte, kLockBytes);
  out.push_back(0xC0);
  return out;
}

std::size_t Cp2112Model::get_report(HidReportKind kind, std::uint8_t number,
                                    std::span<std::uint8_t> out) noexcept {
  if (kind != HidReportKind::Feature) return 0;
  switch (number) {
    case kGpioConfig:
      return fill(out, {number, settings_.outputs, settings_.push_pull, settings_.special,
                        settings_.clock_divider});
    case kGetGpio:
      note_told();
      return fill(out, {number, levels()});
    case kVersion:
      return fill(out, {number, kPartNumber, kHardware});
    case kSmbusConfig:
      if (out.size() < settings_.smbus.size()) return 0;
      std::copy(settings_.smbus.begin(), settings_.smbus.end(), out.begin());
      return settings_.smbus.size();
    case kLockByte:
      return fill(out, {number, 0});  // all is programmed: nothing may be written once more
    default:
      return 0;
  }
}

bool Cp2112Model::set_report(HidReportKind kind, std::span<const std::uint8_t> bytes) noexcept {
  if (kind != HidReportKind::Feature || bytes.empty()) return false;
  const std::uint8_t before = levels();
  if (bytes[0] == kGpioConfig && bytes.size() == kConfigBytes) {
    settings_.outputs = bytes[1];
    settings_.push_pull = bytes[2];
    settings_.special = bytes[3];
    settings_.clock_divider = bytes[4];
  } else if (bytes[0] == kSetGpio && bytes.size() == kSetBytes) {
    const std::uint8_t mask = bytes[2];
    settings_.latch = static_cast<std::uint8_t>((settings_.latch & ~mask) | (bytes[1] & mask));
  } else if (bytes[0] == kSmbusConfig && bytes.size() == kSmbusConfigBytes) {
    std::copy(bytes.begin(), bytes.end(), settings_.smbus.begin());
  } else {
    return false;
  }
  count_changes(before);
  return true;
}

void Cp2112Model::power_cycle() noexcept {
  const std::uint8_t before = levels();
  settings_ = {};
  count_changes(before);
}

bool Cp2112Model::press(unsigned line, bool is_open) noexcept {
  if (line >= kLines) return false;
  const std::uint8_t before = levels();
  const auto bit = static_cast<std::uint8_t>(1U << line);
  wires_ = static_cast<std::uint8_t>(is_open ? wires_ | bit : wires_ & ~bit);
  count_changes(before);
  return true;
}

void Cp2112Model::note_told() noexcept {
  const auto inputs = static_cast<std::uint8_t>(levels() & ~settings_.outputs);
  if (std::exchange(told_, inputs) != inputs) told_at_ = now_;
}

std::vector<plugin::ModelPanel::Reading> Cp2112Model::readings() const {
  std::vector<Reading> out{{"told_s", seconds(told_at_.since_epoch)}};
  for (std::size_t i = 0; i < kLines; ++i) {
    out.push_back({"line_" + std::to_string(i), level(i) ? 1.0 : 0.0});
    out.push_back({"changes_" + std::to_string(i), static_cast<double>(changes_.at(i))});
  }
  return out;
}

bool Cp2112Model::level(std::size_t line) const noexcept {
  return line < kLines && ((levels() >> line) & 1U) != 0;
}

// Open drain: the latch can only pull down.
std::uint8_t Cp2112Model::levels() const noexcept {
  const unsigned pushed = settings_.outputs & settings_.push_pull;
  const unsigned drained = settings_.outputs & ~static_cast<unsigned>(settings_.push_pull);
  const unsigned latch = settings_.latch;
  const unsigned wires = wires_;
  return static_cast<std::uint8_t>((latch & pushed) | (latch & wires & drained) |
                                   (wires & ~static_cast<unsigned>(settings_.outputs)));
}

void Cp2112Model::count_changes(std::uint8_t before) noexcept {
  const unsigned changed = static_cast<unsigned>(before) ^ levels();
  for (std::size_t i = 0; i < kLines; ++i) changes_.at(i) += (changed >> i) & 1U;
}

}  // namespace thimble::sim
