#include "drivers/cambus/usb_link.hpp"

#include <algorithm>
#include <utility>

namespace thimble::cambus {
namespace {

constexpr std::size_t kWordBytes = 4;
// Replies are heard when somebody looks: what is asked for at once must fit into the bus's queue,
// with room for the end of an answer to what was given up.
constexpr std::size_t kMostPacketsToCome = bus::kUsbQueuedPackets * 3 / 4;
// Of one request, so that several are under way.
constexpr std::size_t kReplyPackets = kMostPacketsToCome / 3;

constexpr std::uint64_t losses_of(const bus::UsbCounters& counters) noexcept {
  return counters.stalls + counters.babbles + counters.failures + counters.packets_skipped +
         counters.writes_cut;
}

}  // namespace

UsbLink::UsbLink(std::unique_ptr<bus::UsbDevice> device, std::size_t packet_bytes)
    : device_(std::move(device)), packet_bytes_(packet_bytes) {}

std::shared_ptr<const UsbFetch> UsbLink::read(std::uint32_t offset, std::size_t bytes) {
  const std::size_t most = (kReplyPackets * packet_bytes_ - usb::kHeaderBytes) / kWordBytes - 1;
  const std::size_t chunk = kWordBytes * std::min(most, usb::kMostWords);
  const auto fetch = std::make_shared<UsbFetch>();
  fetch->bytes.resize(bytes);
  fetch->missing = bytes;
  for (std::size_t at = 0; at < bytes; at += chunk) {
    const std::size_t size = std::min(chunk, bytes - at);
    Request request;
    request.head.kind = usb::Kind::Read;
    request.head.words = static_cast<std::uint16_t>(size / kWordBytes);
    request.head.offset = offset + static_cast<std::uint32_t>(at);
    request.fetch = fetch;
    request.place = at;
    requests_.push_back(std::move(request));
  }
  return fetch;
}

// No transfer ends with a whole packet: that would need an empty one behind it, which the bus does
// not send.
void UsbLink::write(std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    std::size_t size = std::min(kMostWriteBytes, bytes.size());
    if ((usb::kHeaderBytes + size) % packet_bytes_ == 0) size -= kWordBytes;
    append_write(offset, bytes.first(size), false);
    bytes = bytes.subspan(size);
    offset += static_cast<std::uint32_t>(size);
  }
}

void UsbLink::write_last(std::uint32_t offset, std::span<const std::uint8_t> bytes) {
  append_write(offset, bytes, true);
}

void UsbLink::append_write(std::uint32_t offset, std::span<const std::uint8_t> bytes,
                           bool is_last) {
  Request request;
  request.head.kind = usb::Kind::Write;
  request.head.words = static_cast<std::uint16_t>(bytes.size() / kWordBytes);
  request.head.offset = offset;
  request.payload.assign(bytes.begin(), bytes.end());
  request.is_last = is_last;
  unwritten_bytes_ += bytes.size();
  requests_.push_back(std::move(request));
}

bool UsbLink::drop_unsent() {
  bool was_last = false;
  while (!requests_.empty() && !requests_.back().is_sent) {
    was_last = was_last || requests_.back().is_last;
    unwritten_bytes_ -= requests_.back().payload.size();
    requests_.pop_back();
  }
  return was_last;
}

// The empty one behind whole packets counts.
std::size_t UsbLink::reply_packets(const UsbHead& head) const noexcept {
  const std::size_t words = head.kind == usb::Kind::Read ? head.words : 0;
  return (usb::kHeaderBytes + kWordBytes * words) / packet_bytes_ + 1;
}

IoStatus UsbLink::pump(MonotonicTime now) {
  const IoStatus heard = hear();
  if (heard != IoStatus::Ok) return heard;
  look_for_losses();
  wait(now);
  return speak();
}

// At most as many as may have waited: a device that never stops is left until the next time.
IoStatus UsbLink::hear() {
  bus::UsbPacket packet;
  for (std::size_t i = 0; i < bus::kUsbQueuedPackets; ++i) {
    const IoStatus status = device_->read(usb::kReplies, packet);
    if (status == IoStatus::NoData) return IoStatus::Ok;
    if (status != IoStatus::Ok) return IoStatus::Disconnected;
    take_packet(packet);
  }
  return IoStatus::Ok;
}

void UsbLink::take_packet(const bus::UsbPacket& packet) {
  const bool is_next = packet.sequence == std::exchange(heard_, packet.sequence) + 1;
  if (!is_next) ++counters_.lost;
  if (!is_next && stream_ == Stream::Running) restart();
  if (stream_ == Stream::Lost) return;
  if (stream_ == Stream::Beginning) {
    // Its answer comes in a packet of its own, behind whatever the board had begun to send.
    const auto reply = parse_usb_reply(packet.payload());
    if (!reply || reply->head != UsbHead{usb::Kind::Begin, {}, begun_with_, 0, 0}) return;
    stream_ = Stream::Running;
    arriving_.clear();
    quiet_ = {};
    return;
  }
  const auto payload = packet.payload();
  arriving_.insert(arriving_.end(), payload.begin(), payload.end());
  if (payload.size() < packet_bytes_ || arriving_.size() > usb::kMostBytes) take_transfer();
}

void UsbLink::take_transfer() {
  const std::vector<std::uint8_t> transfer = std::exchange(arriving_, {});
  const auto reply = parse_usb_reply(transfer);
  if (reply && under_way_ > 0 && is_answer_to(requests_.front(), reply->head)) {
    take_reply(*reply);
    return;
  }
  ++counters_.spoilt;
  restart();
}

bool UsbLink::is_answer_to(const Request& request, const UsbHead& head) const noexcept {
  UsbHead expected = request.head;
  if (expected.kind == usb::Kind::Write) expected.words = 0;
  return head == expected;
}

void UsbLink::take_reply(const UsbReply& reply) {
  Request& request = requests_.front();
  if (request.fetch) {
    std::copy(reply.payload.begin(), reply.payload.end(),
              request.fetch->bytes.begin() + static_cast<std::ptrdiff_t>(request.place));
    request.fetch->missing -= reply.payload.size();
  }
  unwritten_bytes_ -= request.payload.size();
  packets_to_come_ -= reply_packets(request.head);
  --under_way_;
  requests_.pop_front();
  ++counters_.answered;
  quiet_ = {};
  silent_ = {};
}

void UsbLink::look_for_losses() {
  const std::uint64_t losses =
      losses_of(device_->counters(usb::kRequests)) + losses_of(device_->counters(usb::kReplies));
  if (std::exchange(losses_, losses) == losses) return;
  ++counters_.lost;
  restart();
}

void UsbLink::wait(MonotonicTime now) {
  if (requests_.empty()) {
    looked_at_.reset();
    quiet_ = {};
    silent_ = {};
    return;
  }
  const Duration visit =
      looked_at_ ? std::clamp(now - *looked_at_, Duration(0), kVisit) : Duration(0);
  looked_at_ = now;
  quiet_ += visit;
  silent_ += visit;
  if (silent_ >= kGivenUp) is_silent_ = true;
  if (quiet_ < kPatience) return;
  ++counters_.late;
  restart();
}

// A transfer that is leaving is sent to its end: only so the board knows where the next begins.
void UsbLink::restart() noexcept {
  if (stream_ != Stream::Lost) ++counters_.restarts;
  stream_ = Stream::Lost;
  under_way_ = 0;
  packets_to_come_ = 0;
  arriving_.clear();
  quiet_ = {};
}

IoStatus UsbLink::speak() {
  while (left_ < leaving_.size() || prepare()) {
    const auto rest = std::span<const std::uint8_t>(leaving_).subspan(left_);
    const auto packet = rest.first(std::min(rest.size(), packet_bytes_));
    const IoStatus status = device_->submit(usb::kRequests, packet);
    if (status == IoStatus::Backlogged) return IoStatus::Ok;
    if (status != IoStatus::Ok) return IoStatus::Disconnected;
    left_ += packet.size();
  }
  return IoStatus::Ok;
}

bool UsbLink::prepare() {
  if (requests_.empty()) return false;
  left_ = 0;
  leaving_.clear();
  if (stream_ == Stream::Lost) {
    begun_with_ = ++number_;
    stream_ = Stream::Beginning;
    leaving_ = usb_request({usb::Kind::Begin, {}, begun_with_, 0, 0}, {});
    return true;
  }
  if (under_way_ >= std::min(requests_.size(), kMostUnderWay)) return false;
  Request& request = requests_[under_way_];
  const bool has_to_wait = under_way_ > 0 || stream_ != Stream::Running;
  if (request.is_last && has_to_wait) return false;
  const std::size_t packets = reply_packets(request.head);
  if (packets_to_come_ + packets > kMostPacketsToCome) return false;
  packets_to_come_ += packets;
  ++under_way_;
  request.head.number = ++number_;
  request.is_sent = true;
  leaving_ = usb_request(request.head, request.payload);
  ++counters_.sent;
  return true;
}

}  // namespace thimble::cambus
