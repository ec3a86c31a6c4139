#include "sim/export/uhid_wire.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "hal/base/check.hpp"

namespace thimble::sim::uhid {
namespace {

// enum uhid_event_type
constexpr std::uint32_t kDestroy = 1;
constexpr std::uint32_t kStart = 2;
constexpr std::uint32_t kStop = 3;
constexpr std::uint32_t kOpen = 4;
constexpr std::uint32_t kClose = 5;
constexpr std::uint32_t kOutput = 6;
constexpr std::uint32_t kGetReport = 9;
constexpr std::uint32_t kGetReportReply = 10;
constexpr std::uint32_t kCreate2 = 11;
constexpr std::uint32_t kInput2 = 12;
constexpr std::uint32_t kSetReport = 13;
constexpr std::uint32_t kSetReportReply = 14;

// struct uhid_create2_req
constexpr std::size_t kNameBytes = 128;
constexpr std::size_t kPlaceBytes = 64;
constexpr std::size_t kSerialBytes = 64;
constexpr std::uint16_t kBusUsb = 3;  // linux/input.h

// Takes fields off the front; what is not there makes it fail for good.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) noexcept : rest_(bytes) {}

  template <class Number>
  Number take() noexcept {
    Number number{};
    const std::span<const std::uint8_t> bytes = take_bytes(sizeof number);
    if (!bytes.empty()) std::memcpy(&number, bytes.data(), sizeof number);
    return number;
  }
  std::span<const std::uint8_t> take_bytes(std::size_t count) noexcept {
    has_failed_ = has_failed_ || count > rest_.size();
    if (has_failed_) return {};
    const auto bytes = rest_.first(count);
    rest_ = rest_.subspan(count);
    return bytes;
  }
  [[nodiscard]] bool has_failed() const noexcept { return has_failed_; }

 private:
  std::span<const std::uint8_t> rest_;
  bool has_failed_{false};
};

template <class Number>
void append(Bytes& bytes, Number number) {
  const std::size_t end = bytes.size();
  bytes.resize(end + sizeof number);
  std::memcpy(bytes.data() + end, &number, sizeof number);
}

void append(Bytes& bytes, std::span<const std::uint8_t> more) {
  THIMBLE_CHECK(more.size() <= kMaxReportBytes);
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// Ended by a zero, and filled up with them.
void append_text(Bytes& bytes, std::string_view text, std::size_t room) {
  text = text.substr(0, room - 1);
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.resize(bytes.size() + room - text.size());
}

Bytes event(std::uint32_t type) {
  Bytes bytes;
  append(bytes, type);
  return bytes;
}

// enum uhid_report_type
std::optional<plugin::HidReportKind> kind_of(std::uint8_t type) noexcept {
  if (type == 0) return plugin::HidReportKind::Feature;
  if (type == 1) return plugin::HidReportKind::Output;
  if (type == 2) return plugin::HidReportKind::Input;
  return std::nullopt;
}

std::optional<Event> parse_start(Reader reader) noexcept {
  const auto flags = reader.take<std::uint64_t>();
  if (reader.has_failed()) return std::nullopt;
  return Start{(flags & 1U) != 0, (flags & 2U) != 0, (flags & 4U) != 0};
}

std::optional<Event> parse_output(Reader reader) noexcept {
  const std::span<const std::uint8_t> data = reader.take_bytes(kMaxReportBytes);
  const auto size = reader.take<std::uint16_t>();
  const auto kind = kind_of(reader.take<std::uint8_t>());
  if (reader.has_failed() || !kind || size > data.size()) return std::nullopt;
  return Output{*kind, data.first(size)};
}

std::optional<Event> parse_get_report(Reader reader) noexcept {
  GetReport request;
  request.id = reader.take<std::uint32_t>();
  request.number = reader.take<std::uint8_t>();
  const auto kind = kind_of(reader.take<std::uint8_t>());
  if (reader.has_failed() || !kind) return std::nullopt;
  request.kind = *kind;
  return request;
}

std::optional<Event> parse_set_report(Reader reader) noexcept {
  SetReport request;
  request.id = reader.take<std::uint32_t>();
  request.number = reader.take<std::uint8_t>();
  const auto kind = kind_of(reader.take<std::uint8_t>());
  const auto size = reader.take<std::uint16_t>();
  if (reader.has_failed() || !kind || size > kMaxReportBytes) return std::nullopt;
  request.kind = *kind;
  request.bytes = reader.take_bytes(size);
  if (reader.has_failed()) return std::nullopt;
  return request;
}

}  // namespace

std::optional<Event> parse(std::span<const std::uint8_t> bytes) noexcept {
  Reader reader(bytes);
  const auto type = reader.take<std::uint32_t>();
  if (reader.has_failed()) return std::nullopt;
  switch (type) {
    case kStart:
      return parse_start(reader);
    case kStop:
      return Stop{};
    case kOpen:
      return Open{};
    case kClose:
      return Close{};
    case kOutput:
      return parse_output(reader);
    case kGetReport:
      return parse_get_report(reader);
    case kSetReport:
      return parse_set_report(reader);
    default:
      return std::nullopt;
  }
}

Bytes create(const bus::BusDeviceInfo& device, std::span<const std::uint8_t> descriptor) {
  Bytes bytes = event(kCreate2);
  append_text(bytes, device.product, kNameBytes);
  append_text(bytes, device.address.text, kPlaceBytes);
  append_text(bytes, device.serial_number, kSerialBytes);
  append(bytes, static_cast<std::uint16_t>(descriptor.size()));
  append(bytes, kBusUsb);
  append(bytes, std::uint32_t{device.vendor_id});
  append(bytes, std::uint32_t{device.product_id});
  append(bytes, std::uint32_t{0});  // version
  append(bytes, std::uint32_t{0});  // country
  append(bytes, descriptor);
  return bytes;
}

Bytes destroy() { return event(kDestroy); }

Bytes input(std::span<const std::uint8_t> report) {
  Bytes bytes = event(kInput2);
  append(bytes, static_cast<std::uint16_t>(report.size()));
  append(bytes, report);
  return bytes;
}

Bytes get_report_reply(std::uint32_t id, std::uint16_t error,
                       std::span<const std::uint8_t> report) {
  Bytes bytes = event(kGetReportReply);
  append(bytes, id);
  append(bytes, error);
  append(bytes, static_cast<std::uint16_t>(report.size()));
  append(bytes, report);
  return bytes;
}

Bytes set_report_reply(std::uint32_t id, std::uint16_t error) {
  Bytes bytes = event(kSetReportReply);
  append(bytes, id);
  append(bytes, error);
  return bytes;
}

}  // namespace thimble::sim::uhid
