#include "sim/model/cam/cam_usb_model.hpp"

namespace thimble::sim::cam {
namespace {

namespace usb = cambus::usb;
using plugin::UsbHandshake;
using usb::Status;

// pid.codes keeps these for tests (docs/cambus.md, section 7).
constexpr std::uint16_t kVendorId = 0x1209;
constexpr std::uint16_t kProductId = 0x0001;

constexpr std::uint32_t kWordBytes = 4;

}  // namespace

CamUsbModel::CamUsbModel(const BoardOptions& options, std::size_t packet_bytes)
    : options_(options),
      packet_bytes_(packet_bytes),
      memory_(BoardPage::bytes_of(options)),
      requests_(packet_bytes),
      replies_(packet_bytes) {}

bus::BusDeviceInfo CamUsbModel::describe() const {
  const auto packet = static_cast<std::uint16_t>(packet_bytes_);
  bus::BusDeviceInfo info;
  info.vendor_id = kVendorId;
  info.product_id = kProductId;
  info.manufacturer = "Thimble";
  info.product = usb::kProduct;
  info.endpoints = {{usb::kInterface, usb::kRequests, bus::UsbTransferKind::Bulk, packet, 0},
                    {usb::kInterface, usb::kReplies, bus::UsbTransferKind::Bulk, packet, 0}};
  return info;
}

void CamUsbModel::advance(MonotonicTime t) noexcept {
  now_ = t;
  if (!board_) board_.emplace(options_, memory_.words(), now_);
}

plugin::UsbAnswer CamUsbModel::control(const bus::UsbControlRequest& /*request*/,
                                       std::span<std::uint8_t> /*in*/) noexcept {
  return {UsbHandshake::Stall, 0};
}

UsbHandshake CamUsbModel::out_packet(std::uint8_t endpoint,
                                     std::span<const std::uint8_t> bytes) noexcept {
  if (endpoint != usb::kRequests || !board_) return UsbHandshake::Stall;
  const bool has_room = replies_.transfers() < usb::kMostReplies &&
                        replies_.bytes() + usb::kMostBytes <= usb::kMostReplyBytes;
  if (requests_.is_between_transfers() && !has_room) {
    ++counters_.put_off;
    return UsbHandshake::Nak;
  }
  if (requests_.take(bytes)) take(requests_.transfer());
  return UsbHandshake::Ack;
}

plugin::UsbAnswer CamUsbModel::in_packet(std::uint8_t endpoint,
                                         std::span<std::uint8_t> out) noexcept {
  if (endpoint != usb::kReplies) return {UsbHandshake::Stall, 0};
  const auto size = replies_.next(out);
  if (!size) return {};
  return {UsbHandshake::Ack, *size};
}

MonotonicTime CamUsbModel::unchanged_until() const noexcept {
  return replies_.transfers() == 0 ? MonotonicTime{Duration::max()} : now_;
}

void CamUsbModel::power_cycle() noexcept {
  board_.reset();
  const bus::SharedWords words = memory_.words();
  for (std::uint32_t at = 0; at < words.bytes(); at += kWordBytes) words.store(at, 0);
  ++options_.incarnation;
  requests_.clear();
  replies_.clear();
  next_number_.reset();
}

std::vector<plugin::ModelPanel::Reading> CamUsbModel::readings() const {
  if (!board_) return {};
  const CamCounters& machine = board_->machine().counters();
  const BoardCounters& board = board_->counters();
  return {{"doorbells", static_cast<double>(board.doorbells)},
          {"scans", static_cast<double>(machine.scans)},
          {"disturbed_scans", static_cast<double>(machine.disturbed_scans)},
          {"unmodelled", static_cast<double>(machine.unmodelled)}};
}

void CamUsbModel::take(std::span<const std::uint8_t> transfer) {
  const auto request = parse_usb_request(transfer);
  if (!request) {
    ++counters_.malformed;
    next_number_.reset();
    answer({}, Status::Malformed);
    return;
  }
  if (request->kind == usb::Kind::Begin) {
    ++counters_.begins;
    next_number_ = static_cast<std::uint16_t>(request->number + 1);
    replies_.clear();
    answer(*request, Status::Done);
    return;
  }
  if (!is_in_order(*request)) {
    ++counters_.out_of_order;
    answer(*request, Status::OutOfOrder);
    return;
  }
  const Status status = check(*request);
  if (status == Status::Done) return carry_out(*request);
  ++counters_.refused;
  answer(*request, status);
}

bool CamUsbModel::is_in_order(const UsbRequest& request) noexcept {
  if (next_number_ != request.number) {
    next_number_.reset();
    return false;
  }
  ++*next_number_;
  return true;
}

Status CamUsbModel::check(const UsbRequest& request) const noexcept {
  if (request.offset % kWordBytes != 0) return Status::NotAligned;
  const std::uint64_t end = request.offset + std::uint64_t{kWordBytes} * request.words;
  return end <= BoardPage::bytes_of(options_) ? Status::Done : Status::OutOfRange;
}

void CamUsbModel::carry_out(const UsbRequest& request) {
  ++counters_.carried_out;
  const bus::SharedWords words = memory_.words();
  serve();
  std::uint32_t at = request.offset;
  if (request.kind == usb::Kind::Write) {
    for (const std::uint32_t word : request.payload) {
      words.store(at, word);
      at += kWordBytes;
    }
    serve();
    return answer(request, Status::Done);
  }
  std::vector<std::uint32_t> payload(request.words);
  for (std::uint32_t& word : payload) {
    word = words.load(at);
    at += kWordBytes;
  }
  answer(request, Status::Done, payload);
}

void CamUsbModel::serve() {
  if (!is_frozen_) board_->serve(now_);
}

void CamUsbModel::answer(const UsbRequest& request, Status status,
                         std::span<const std::uint32_t> payload) {
  replies_.add(make_usb_reply(request, status, payload));
}

}  // namespace thimble::sim::cam
