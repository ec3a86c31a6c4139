#include "sim/export/usbip_session.hpp"

#include <algorithm>
#include <bitset>
#include <cerrno>
#include <utility>

#include "sim/bus/sim_usb_port.hpp"
#include "sim/export/usb_requests.hpp"

namespace thimble::sim {
namespace {

using bus::UsbTransferKind;
using plugin::UsbAnswer;
using plugin::UsbHandshake;

constexpr std::size_t kBytesPerFrame = 1500;  // 12 Mbit/s for 1 ms
constexpr std::uint32_t kShortNotOk = 1;      // USBIP_URB_SHORT_NOT_OK, linux/usbip.h
constexpr std::uint32_t kZeroPacket = 0x40;   // USBIP_URB_ZERO_PACKET, there
constexpr std::size_t kAddresses = 32;        // 16 numbers, two directions

std::size_t slot_of(const usbip::Submit& submit) noexcept {
  // Endpoint 0 is one for both directions.
  return submit.endpoint == 0 ? 0 : submit.endpoint + (submit.is_in ? kAddresses / 2 : 0);
}

}  // namespace

UsbipSession::UsbipSession(plugin::SimUsbModel& model, const UsbPersona& persona,
                           unsigned rounds_per_frame, const PlugSurroundings& surroundings)
    : model_(&model),
      persona_(&persona),
      around_(surroundings),
      rounds_per_frame_(rounds_per_frame) {}

// ---- what the host says -------------------------------------------------------------------

std::size_t UsbipSession::message_bytes() const {
  if (!is_attached_) {
    if (inbox_.size() < usbip::kOpHeaderBytes) return 0;
    return usbip::op_request_bytes(inbox_).value_or(inbox_.size());
  }
  if (inbox_.size() < usbip::kHeaderBytes) return 0;
  const auto header = usbip::parse_header(std::span(inbox_).first<usbip::kHeaderBytes>());
  const auto* submit = header ? std::get_if<usbip::Submit>(&*header) : nullptr;
  if (submit == nullptr || submit->is_in || submit->length > kMaxTransferBytes) {
    return usbip::kHeaderBytes;
  }
  return usbip::kHeaderBytes + submit->length;
}

bool UsbipSession::take(std::span<const std::uint8_t> bytes) {
  inbox_.insert(inbox_.end(), bytes.begin(), bytes.end());
  bool is_sound = true;
  for (;;) {
    const std::size_t size = message_bytes();
    if (size == 0 || size > inbox_.size()) break;
    is_sound = take_message(std::span(inbox_).first(size));
    inbox_.erase(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(size));
    if (!is_sound) break;
  }
  if (!is_sound) ++counters_.malformed;
  return is_sound && outbox_.size() <= kMaxOutboxBytes;
}

bool UsbipSession::take_message(std::span<const std::uint8_t> message) {
  if (!is_attached_) return take_op(message);
  const auto header = usbip::parse_header(message.first<usbip::kHeaderBytes>());
  if (!header) return false;
  if (const auto* unlink = std::get_if<usbip::Unlink>(&*header)) {
    take_unlink(*unlink);
    return true;
  }
  return take_submit(std::get<usbip::Submit>(*header), message.subspan(usbip::kHeaderBytes));
}

usbip::DeviceRecord UsbipSession::record() const {
  usbip::DeviceRecord record;
  record.path = persona_->info.address.text;
  record.bus_id = kBusId;
  record.vendor_id = persona_->info.vendor_id;
  record.product_id = persona_->info.product_id;
  record.version = 0x0100;
  record.class_code = persona_->class_code;
  for (const UsbInterface& interface : interfaces_of(*persona_)) {
    record.interfaces.push_back({interface.class_code, interface.subclass, interface.protocol});
  }
  return record;
}

bool UsbipSession::take_op(std::span<const std::uint8_t> message) {
  const auto request = usbip::parse_op_request(message);
  if (!request) return false;
  const usbip::DeviceRecord device = record();
  usbip::Bytes reply;
  if (const auto* import = std::get_if<usbip::ImportRequest>(&*request)) {
    is_attached_ = is_available_ && import->bus_id == kBusId;
    reply = usbip::import_reply(is_attached_ ? &device : nullptr);
  } else {
    reply = usbip::devlist_reply(is_available_ ? &device : nullptr);
  }
  outbox_.insert(outbox_.end(), reply.begin(), reply.end());
  is_answered_ = true;
  return true;
}

bool UsbipSession::take_submit(const usbip::Submit& submit, std::span<const std::uint8_t> data) {
  if (submit.device_id != kDeviceId || submit.is_isochronous()) return false;
  if (submit.length > kMaxTransferBytes || transfers_.size() >= kMaxTransfers) return false;
  transfers_.push_back({submit, {data.begin(), data.end()}, {}, 0});
  is_under_way_ = is_under_way_ || !waits_for_model(transfers_.back());
  return true;
}

// The others are answered in the next round, whatever the model has.
bool UsbipSession::waits_for_model(const Transfer& transfer) const noexcept {
  if (!transfer.submit.is_in || transfer.submit.length == 0) return false;
  return transfer.submit.endpoint != 0 && endpoint_of(transfer) != nullptr;
}

void UsbipSession::take_unlink(const usbip::Unlink& unlink) {
  const auto found = std::find_if(
      transfers_.begin(), transfers_.end(),
      [&](const Transfer& transfer) { return transfer.submit.seqnum == unlink.unlinked; });
  const bool is_there = found != transfers_.end();
  if (is_there) transfers_.erase(found);
  const usbip::Bytes reply = usbip::unlink_reply(unlink.seqnum, is_there ? -ECONNRESET : 0);
  outbox_.insert(outbox_.end(), reply.begin(), reply.end());
}

// ---- the bus ------------------------------------------------------------------------------

void UsbipSession::serve(MonotonicTime now) {
  ++round_;
  const bool is_used = std::any_of(transfers_.begin(), transfers_.end(), [](const auto& transfer) {
    return transfer.submit.endpoint != 0;
  });
  if (is_used) used_at_ = now;
  is_under_way_ = around_.misbehaviour->is_silent(now);
  if (is_under_way_) {
    if (!transfers_.empty()) around_.misbehaviour->note_unanswered();
    return;
  }
  bytes_left_ = kBytesPerFrame / rounds_per_frame_;
  serve_kind(UsbTransferKind::Interrupt, now);
  serve_kind(UsbTransferKind::Control, now);
  serve_kind(UsbTransferKind::Bulk, now);
}

MonotonicTime UsbipSession::next_needed(MonotonicTime now) const noexcept {
  const Duration round = kUsbFrame / rounds_per_frame_;
  const MonotonicTime frame = now + (rounds_per_frame_ - round_ % rounds_per_frame_) * round;
  if (transfers_.empty() && outbox_.empty()) return frame;
  const bool is_next = is_under_way_ || !outbox_.empty() || around_.misbehaviour->is_stalling(now);
  const MonotonicTime changes = is_next ? now : model_->unchanged_until();
  if (changes >= frame) return frame;
  const auto rounds = (std::max(changes - now, Duration(1)) + round - Duration(1)) / round;
  return now + rounds * round;
}

const bus::UsbEndpointInfo* UsbipSession::endpoint_of(const Transfer& transfer) const noexcept {
  const auto address = static_cast<std::uint8_t>(transfer.submit.endpoint |
                                                 (transfer.submit.is_in ? bus::kUsbInBit : 0U));
  const auto& endpoints = persona_->info.endpoints;
  const auto found = std::find_if(endpoints.begin(), endpoints.end(), [&](const auto& endpoint) {
    return endpoint.address == address;
  });
  return found == endpoints.end() ? nullptr : &*found;
}

bool UsbipSession::is_due(const bus::UsbEndpointInfo& endpoint) const noexcept {
  if (endpoint.kind == UsbTransferKind::Bulk) return true;
  const std::uint64_t interval = std::max<std::uint64_t>(endpoint.interval, 1);
  return round_ % rounds_per_frame_ == 0 && round_ / rounds_per_frame_ % interval == 0;
}

void UsbipSession::serve_kind(UsbTransferKind kind, MonotonicTime now) {
  std::bitset<kAddresses> is_over;  // endpoints that have nothing more for this round
  for (auto transfer = transfers_.begin(); transfer != transfers_.end();) {
    const std::size_t slot = slot_of(transfer->submit);
    const bus::UsbEndpointInfo* endpoint = slot == 0 ? nullptr : endpoint_of(*transfer);
    // One that does not exist stalls with the requests to endpoint 0.
    const UsbTransferKind its_kind =
        endpoint == nullptr ? UsbTransferKind::Control : endpoint->kind;
    if (its_kind != kind || is_over[slot] ||
        (endpoint != nullptr && (is_halted(*endpoint) || !is_due(*endpoint)))) {
      ++transfer;
      continue;
    }
    Progress progress{};
    if (slot == 0) {
      progress = control(*transfer, now);
    } else if (endpoint == nullptr || around_.misbehaviour->refuses(now)) {
      is_under_way_ = true;  // so is the next one, if there is one
      progress = end(*transfer, -EPIPE);
    } else if (around_.misbehaviour->halts(transfer->submit.is_in)) {
      progress = halt(*transfer, *endpoint);
    } else {
      progress = transfer->submit.is_in ? fetch(*transfer, *endpoint, now)
                                        : send(*transfer, *endpoint, now);
    }
    // An interrupt pipe has one transaction when it is due, endpoint 0 one request in a round.
    is_over[slot] = progress == Progress::Waits || kind != UsbTransferKind::Bulk;
    transfer = progress == Progress::Ended ? transfers_.erase(transfer) : std::next(transfer);
  }
}

UsbipSession::Progress UsbipSession::end(const Transfer& transfer, std::int32_t status) {
  const usbip::Submit& submit = transfer.submit;
  const std::size_t actual = submit.is_in ? transfer.in.size() : transfer.done;
  const bool is_short = submit.is_in && actual < submit.length;
  if (status == 0 && is_short && (submit.flags & kShortNotOk) != 0) status = -EREMOTEIO;
  const usbip::Bytes reply =
      usbip::submit_reply(submit, status, static_cast<std::uint32_t>(actual), transfer.in);
  outbox_.insert(outbox_.end(), reply.begin(), reply.end());
  if (status == -EPIPE) ++counters_.lost;
  return Progress::Ended;
}

UsbipSession::Progress UsbipSession::put_off() noexcept {
  is_under_way_ = true;
  return Progress::Waits;
}

UsbipSession::Progress UsbipSession::halt(const Transfer& transfer,
                                          const bus::UsbEndpointInfo& endpoint) {
  halted_.push_back(endpoint);
  return end(transfer, -EPIPE);
}

bool UsbipSession::is_halted(const bus::UsbEndpointInfo& endpoint) const noexcept {
  return std::find(halted_.begin(), halted_.end(), endpoint) != halted_.end();
}

UsbipSession::Progress UsbipSession::control(Transfer& transfer, MonotonicTime now) {
  const bus::UsbControlRequest request = control_request(transfer.submit.setup, transfer.data);
  ++counters_.requests;
  is_under_way_ = true;  // it may be one of many, or change what the device says elsewhere
  if (around_.misbehaviour->refuses(now)) return end(transfer, -EPIPE);
  if (!is_standard(request)) return class_request(transfer, request, now);
  // An answer of a write has no data, whatever its setup asks for: they would be the next header.
  if (!transfer.submit.is_in && bus::asks_for_data(request) && request.length > 0) {
    return end(transfer, -EPIPE);
  }
  const auto answer = answer_standard(*persona_, request, configuration_);
  if (!answer) return end(transfer, -EPIPE);
  std::erase_if(halted_, [&](const auto& endpoint) { return ends_halt(request, endpoint); });
  const std::size_t most = std::min<std::size_t>(request.length, transfer.submit.length);
  transfer.in.assign(answer->begin(),
                     answer->begin() + static_cast<std::ptrdiff_t>(std::min(answer->size(), most)));
  return end(transfer, 0);
}

UsbipSession::Progress UsbipSession::class_request(Transfer& transfer,
                                                   const bus::UsbControlRequest& request,
                                                   MonotonicTime now) {
  const std::size_t wanted = std::min<std::size_t>(request.length, transfer.submit.length);
  // The model's requests have no longer data stages.
  if (wanted > bus::kMaxUsbControlBytes || transfer.submit.is_in != bus::asks_for_data(request)) {
    return end(transfer, -EPIPE);
  }
  std::array<std::uint8_t, bus::kMaxUsbControlBytes> room{};
  const bool is_in = bus::asks_for_data(request);
  const UsbAnswer answer = model_->control(request, {room.data(), is_in ? wanted : 0U});
  if (answer.handshake == UsbHandshake::Nak) {
    --counters_.requests;  // it is the same one that comes again
    return put_off();
  }
  if (!is_in) {
    around_.log->note_bytes(around_.time(now), ModelLog::Direction::Requested,
                            std::span(request.data).first(wanted));
  }
  if (answer.handshake == UsbHandshake::Stall) return end(transfer, -EPIPE);
  if (is_in && answer.size > wanted) return end(transfer, -EOVERFLOW);
  if (is_in)
    transfer.in.assign(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(answer.size));
  transfer.done = transfer.data.size();
  return end(transfer, 0);
}

UsbipSession::Progress UsbipSession::send(Transfer& transfer, const bus::UsbEndpointInfo& endpoint,
                                          MonotonicTime now) {
  // A transfer of nothing is one packet of nothing; a longer one has it last where the host asks
  // for an end that a whole packet does not say.
  const bool is_whole = transfer.data.size() % endpoint.max_packet_bytes == 0;
  const bool ends_empty =
      transfer.data.empty() || (is_whole && (transfer.submit.flags & kZeroPacket) != 0);
  while (transfer.done < transfer.data.size() || ends_empty) {
    const auto packet = std::span(transfer.data).subspan(transfer.done);
    const auto sent = packet.first(std::min<std::size_t>(packet.size(), endpoint.max_packet_bytes));
    if (!take_budget(kUsbPacketOverheadBytes + sent.size())) return put_off();
    const auto bytes = around_.misbehaviour->taken_of(sent);
    const UsbHandshake handshake = model_->out_packet(endpoint.address, bytes);
    if (handshake == UsbHandshake::Nak) return put_off();
    if (handshake == UsbHandshake::Stall) return halt(transfer, endpoint);
    around_.misbehaviour->note_taken(sent);
    around_.log->note_bytes(around_.time(now), ModelLog::Direction::ToModel, bytes);
    ++counters_.from_host;
    transfer.done += bytes.size();
    if (bytes.empty() || bytes.size() < sent.size()) break;
  }
  return end(transfer, 0);
}

UsbipSession::Progress UsbipSession::fetch(Transfer& transfer, const bus::UsbEndpointInfo& endpoint,
                                           MonotonicTime now) {
  std::array<std::uint8_t, bus::kMaxUsbPacketBytes> buffer{};
  const std::size_t most = std::min<std::size_t>(endpoint.max_packet_bytes, buffer.size());
  const std::span<std::uint8_t> room(buffer.data(), most);
  while (transfer.in.size() < transfer.submit.length) {
    // The bus cannot know how much will come, so there must be time for a whole packet.
    if (bytes_left_ < kUsbPacketOverheadBytes + most) return put_off();
    const UsbAnswer answer = model_->in_packet(endpoint.address, room);
    if (answer.handshake == UsbHandshake::Nak) return Progress::Waits;
    if (answer.handshake == UsbHandshake::Stall) return halt(transfer, endpoint);
    const std::size_t size = around_.misbehaviour->spoil(room, answer.size);
    take_budget(kUsbPacketOverheadBytes + std::min(size, most));
    if (size > most || transfer.in.size() + size > transfer.submit.length) {
      return end(transfer, -EOVERFLOW);
    }
    around_.log->note_bytes(around_.time(now), ModelLog::Direction::ToHost, room.first(size));
    ++counters_.to_host;
    transfer.in.insert(transfer.in.end(), room.begin(),
                       room.begin() + static_cast<std::ptrdiff_t>(size));
    if (size < most) break;  // a short packet ends a transfer
  }
  return end(transfer, 0);
}

bool UsbipSession::take_budget(std::size_t bytes) noexcept {
  if (bytes > bytes_left_) return false;
  bytes_left_ -= bytes;
  return true;
}

}  // namespace thimble::sim
