#include "sim/export/acm_on_usb.hpp"

#include <algorithm>

namespace thimble::sim {
namespace {

using bus::UsbTransferKind;
using plugin::UsbAnswer;
using plugin::UsbHandshake;

constexpr std::uint8_t kCommunication = 0;
constexpr std::uint8_t kData = 1;

// CDC 1.2, section 4: class of the device; class, subclass and protocol of the interfaces.
constexpr std::uint8_t kDeviceClass = 0x02;
constexpr std::uint8_t kClassCommunication = 0x02;
constexpr std::uint8_t kSubclassAcm = 0x02;
constexpr std::uint8_t kProtocolAt = 0x01;  // V.250; none is spoken, but hosts look for it
constexpr std::uint8_t kClassData = 0x0A;

// Functional descriptors: CDC 1.2, 5.2.3; PSTN 1.2, 5.3.
constexpr std::uint8_t kCsInterface = 0x24;
constexpr std::uint8_t kHeader = 0x00;
constexpr std::uint8_t kCallManagement = 0x01;
constexpr std::uint8_t kAcm = 0x02;
constexpr std::uint8_t kUnion = 0x06;
constexpr std::uint8_t kNoCalls = 0x00;       // it manages none
constexpr std::uint8_t kHasLineState = 0x02;  // the three requests below

// bmRequestType: class, to an interface; in bit 7 the direction. bRequest: PSTN 1.2, 6.3.
constexpr std::uint8_t kClassOut = 0x21;
constexpr std::uint8_t kClassIn = 0xA1;
constexpr std::uint8_t kSetLineCoding = 0x20;
constexpr std::uint8_t kGetLineCoding = 0x21;
constexpr std::uint8_t kSetControlLineState = 0x22;

// Ours: a notification of PSTN 1.2, 6.5.4, has 10 bytes, and none is urgent.
constexpr std::uint16_t kNotificationBytes = 16;
constexpr std::uint8_t kNotificationInterval = 16;

// Communication and data.
std::vector<UsbInterface> interfaces() {
  const DescriptorBytes functional{5,
                                   kCsInterface,
                                   kHeader,
                                   0x20,
                                   0x01,  // version 1.2
                                   5,
                                   kCsInterface,
                                   kCallManagement,
                                   kNoCalls,
                                   kData,  //
                                   4,
                                   kCsInterface,
                                   kAcm,
                                   kHasLineState,  //
                                   5,
                                   kCsInterface,
                                   kUnion,
                                   kCommunication,
                                   kData};
  return {{kCommunication, kClassCommunication, kSubclassAcm, kProtocolAt, functional},
          {kData, kClassData, 0, 0, {}}};
}

}  // namespace

bus::BusDeviceInfo AcmOnUsb::describe() const {
  bus::BusDeviceInfo info = model_->describe();
  info.kind = bus::BusKind::Usb;
  info.endpoints = {{kCommunication, kNotifications, UsbTransferKind::Interrupt, kNotificationBytes,
                     kNotificationInterval},
                    {kData, kOut, UsbTransferKind::Bulk, kPacketBytes, 0},
                    {kData, kIn, UsbTransferKind::Bulk, kPacketBytes, 0}};
  return info;
}

UsbPersona AcmOnUsb::persona(const bus::BusDeviceInfo& info) const {
  UsbPersona persona{info, {}};
  persona.info.endpoints = describe().endpoints;
  persona.class_code = kDeviceClass;
  persona.interfaces = interfaces();
  return persona;
}

bool AcmOnUsb::hand_over() noexcept {
  const std::size_t size = packet_end_ - packet_begin_;
  if (size == 0) return true;
  packet_begin_ += std::min(model_->take({packet_.data() + packet_begin_, size}), size);
  return packet_begin_ == packet_end_;
}

void AcmOnUsb::advance(MonotonicTime t) noexcept {
  model_->advance(t);
  static_cast<void>(hand_over());
}

UsbAnswer AcmOnUsb::control(const bus::UsbControlRequest& request,
                            std::span<std::uint8_t> in) noexcept {
  if (request.index != kCommunication) return {UsbHandshake::Stall, 0};
  if (request.request_type == kClassOut && request.request == kSetLineCoding) {
    if (request.length != line_.size()) return {UsbHandshake::Stall, 0};
    std::copy_n(request.data.begin(), line_.size(), line_.begin());
    return {UsbHandshake::Ack, 0};
  }
  if (request.request_type == kClassOut && request.request == kSetControlLineState) {
    control_lines_ = request.value;
    return {UsbHandshake::Ack, 0};
  }
  if (request.request_type == kClassIn && request.request == kGetLineCoding) {
    const std::size_t sent = std::min(line_.size(), in.size());
    std::copy_n(line_.begin(), sent, in.begin());
    return {UsbHandshake::Ack, sent};
  }
  return {UsbHandshake::Stall, 0};
}

UsbHandshake AcmOnUsb::out_packet(std::uint8_t endpoint,
                                  std::span<const std::uint8_t> bytes) noexcept {
  if (endpoint != kOut || bytes.size() > packet_.size()) return UsbHandshake::Stall;
  if (!hand_over()) return UsbHandshake::Nak;
  std::copy(bytes.begin(), bytes.end(), packet_.begin());
  packet_begin_ = 0;
  packet_end_ = bytes.size();
  static_cast<void>(hand_over());
  return UsbHandshake::Ack;
}

UsbAnswer AcmOnUsb::in_packet(std::uint8_t endpoint, std::span<std::uint8_t> out) noexcept {
  if (endpoint == kNotifications) return {UsbHandshake::Nak, 0};
  if (endpoint != kIn) return {UsbHandshake::Stall, 0};
  const std::size_t most = std::min(out.size(), kPacketBytes);
  const std::size_t size = std::min(model_->give(out.first(most)), most);
  if (size == 0 && !is_end_owed_) return {UsbHandshake::Nak, 0};
  is_end_owed_ = size == kPacketBytes;
  return {UsbHandshake::Ack, size};
}

MonotonicTime AcmOnUsb::unchanged_until() const noexcept {
  const bool has_news = packet_begin_ != packet_end_ || is_end_owed_;
  return has_news ? MonotonicTime{} : model_->unchanged_until();
}

void AcmOnUsb::power_cycle() noexcept {
  line_ = kLineAtPowerUp;
  control_lines_ = 0;
  packet_begin_ = packet_end_ = 0;
  is_end_owed_ = false;
  model_->power_cycle();
}

}  // namespace thimble::sim
