#include "sim/export/hid_on_usb.hpp"

#include <algorithm>
#include <optional>

namespace thimble::sim {
namespace {

using plugin::HidReportKind;
using plugin::UsbAnswer;
using plugin::UsbHandshake;

// bmRequestType: class, to an interface; in bit 7 the direction.
constexpr std::uint8_t kClassOut = 0x21;
constexpr std::uint8_t kClassIn = 0xA1;
// bRequest.
constexpr std::uint8_t kGetReport = 0x01;
constexpr std::uint8_t kSetReport = 0x09;
constexpr std::uint8_t kSetIdle = 0x0A;

constexpr std::uint16_t kPacketBytes = 64;

std::optional<HidReportKind> kind_of(std::uint16_t value) noexcept {
  switch (value >> 8U) {
    case 1:
      return HidReportKind::Input;
    case 2:
      return HidReportKind::Output;
    case 3:
      return HidReportKind::Feature;
    default:
      return std::nullopt;
  }
}

}  // namespace

bus::BusDeviceInfo HidOnUsb::describe() const {
  bus::BusDeviceInfo info = model_->describe();
  info.kind = bus::BusKind::Usb;
  // A device that has something to say less often than in every frame asks to be asked less often.
  const auto interval = static_cast<std::uint8_t>(
      std::clamp<std::int64_t>(model_->frame_period() / std::chrono::milliseconds(1), 1, 255));
  info.endpoints = {{0, kIn, bus::UsbTransferKind::Interrupt, kPacketBytes, interval}};
  if (info.output_report_bytes > 0) {
    info.endpoints.push_back({0, kOut, bus::UsbTransferKind::Interrupt, kPacketBytes, interval});
  }
  return info;
}

UsbPersona HidOnUsb::persona(const bus::BusDeviceInfo& info) const {
  UsbPersona persona{info, model_->report_descriptor()};
  persona.info.endpoints = describe().endpoints;
  return persona;
}

UsbAnswer HidOnUsb::control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept {
  const std::optional<HidReportKind> kind = kind_of(request.value);
  if (request.request_type == kClassOut && request.request == kSetIdle) {
    return {UsbHandshake::Ack, 0};  // a report only when there is news: as it does anyway
  }
  if (request.request_type == kClassOut && request.request == kSetReport && kind) {
    const std::size_t size = std::min<std::size_t>(request.length, request.data.size());
    const bool is_taken = model_->set_report(*kind, {request.data.data(), size});
    return {is_taken ? UsbHandshake::Ack : UsbHandshake::Stall, 0};
  }
  if (request.request_type == kClassIn && request.request == kGetReport && kind) {
    std::array<std::uint8_t, bus::kMaxHidReportBytes> report{};
    const auto number = static_cast<std::uint8_t>(request.value & 0xFFU);
    const std::size_t size = std::min(model_->get_report(*kind, number, report), report.size());
    if (size == 0) return {UsbHandshake::Stall, 0};
    const std::size_t sent = std::min(size, in.size());
    std::copy_n(report.begin(), sent, in.begin());
    return {UsbHandshake::Ack, sent};
  }
  return {UsbHandshake::Stall, 0};
}

UsbHandshake HidOnUsb::out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept {
  if (endpoint != kOut) return UsbHandshake::Stall;
  if (!bytes.empty()) model_->out_report(bytes);  // nothing is no report
  return UsbHandshake::Ack;
}

UsbAnswer HidOnUsb::in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept {
  if (endpoint != kIn) return {UsbHandshake::Stall, 0};
  const std::size_t size = model_->in_report(out);
  return {size == 0 ? UsbHandshake::Nak : UsbHandshake::Ack, size};
}

}  // namespace thimble::sim
