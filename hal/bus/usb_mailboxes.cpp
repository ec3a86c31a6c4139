#include "hal/bus/usb_mailboxes.hpp"

#include <algorithm>
#include <string>

namespace thimble::bus {
namespace {

// The number of an endpoint as the tools print it: 0x81.
std::string name_of(std::uint8_t endpoint) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  return std::string("0x") + kDigits[endpoint / 16] + kDigits[endpoint % 16];
}

Result<UsbOpenPipe> resolve(const UsbPipe& pipe, std::uint8_t interface_number,
                            std::span<const UsbEndpointInfo> endpoints) {
  const auto info =
      std::find_if(endpoints.begin(), endpoints.end(), [&](const UsbEndpointInfo& endpoint) {
        return endpoint.address == pipe.endpoint && endpoint.interface_number == interface_number;
      });
  const std::string name = "endpoint " + name_of(pipe.endpoint);
  if (info == endpoints.end()) {
    return fail(Errc::InvalidArgument, "the device has no " + name + " in that interface");
  }
  if (info->kind != UsbTransferKind::Bulk && info->kind != UsbTransferKind::Interrupt) {
    return fail(Errc::InvalidArgument, name + " is neither bulk nor interrupt");
  }
  if (info->max_packet_bytes == 0 || info->max_packet_bytes > kMaxUsbPacketBytes) {
    return fail(Errc::InvalidArgument, name + " has packets of " +
                                           std::to_string(info->max_packet_bytes) +
                                           " bytes; 1 to 512 can be used");
  }
  return UsbOpenPipe{pipe, *info};
}

}  // namespace

Result<std::vector<UsbOpenPipe>> resolve_claim(const UsbClaim& claim,
                                               std::span<const UsbEndpointInfo> endpoints) {
  std::vector<UsbOpenPipe> pipes;
  for (const UsbPipe& wanted : claim.pipes) {
    const bool is_repeated = std::any_of(
        pipes.begin(), pipes.end(),
        [&](const UsbOpenPipe& earlier) { return earlier.pipe.endpoint == wanted.endpoint; });
    if (is_repeated) {
      return fail(Errc::InvalidArgument, "endpoint " + name_of(wanted.endpoint) + " claimed twice");
    }
    Result<UsbOpenPipe> pipe = resolve(wanted, claim.interface_number, endpoints);
    if (!pipe.has_value()) return tl::unexpected(pipe.error());
    pipes.push_back(pipe.value());
  }
  return pipes;
}

void UsbMailboxes::Endings::add(UsbOutcome outcome) noexcept {
  switch (outcome) {
    case UsbOutcome::Done:
      done_.fetch_add(1, std::memory_order_relaxed);
      return;
    case UsbOutcome::Stalled:
      stalled_.fetch_add(1, std::memory_order_relaxed);
      return;
    case UsbOutcome::Babbled:
      babbled_.fetch_add(1, std::memory_order_relaxed);
      return;
    case UsbOutcome::Failed:
      failed_.fetch_add(1, std::memory_order_relaxed);
      return;
  }
}

void UsbMailboxes::Endings::write_to(UsbCounters& counters) const noexcept {
  counters.stalls = stalled_.load(std::memory_order_relaxed);
  counters.babbles = babbled_.load(std::memory_order_relaxed);
  counters.failures = failed_.load(std::memory_order_relaxed);
}

class UsbMailboxes::InPipe {
 public:
  explicit InPipe(UsbDelivery delivery)
      : queue_(delivery == UsbDelivery::Every ? std::make_unique<Queue>() : nullptr) {}

  IoStatus read(UsbPacket& out) noexcept {
    const bool is_there = queue_ != nullptr ? queue_->pop(out) : newest_.read(out);
    if (!is_there) return IoStatus::NoData;
    skipped_.fetch_add(out.sequence - last_read_ - 1, std::memory_order_relaxed);
    last_read_ = out.sequence;
    return IoStatus::Ok;
  }
  bool finish(UsbOutcome outcome, std::span<const std::uint8_t> packet, MonotonicTime at) noexcept {
    endings_.add(outcome);
    if (outcome != UsbOutcome::Done) return true;
    arriving_.size = std::min(packet.size(), arriving_.bytes.size());
    std::copy_n(packet.begin(), arriving_.size, arriving_.bytes.begin());
    arriving_.arrived_at = at;
    ++arriving_.sequence;
    if (queue_ != nullptr) return queue_->push(arriving_);
    newest_.write(arriving_);
    return true;
  }
  void write_to(UsbCounters& counters) const noexcept {
    endings_.write_to(counters);
    counters.packets_in = endings_.done();
    counters.packets_skipped = skipped_.load(std::memory_order_relaxed);
  }

 private:
  using Queue = rt::SpscRing<UsbPacket, kUsbQueuedPackets>;

  std::unique_ptr<Queue> queue_;  // Every
  rt::TripleBuffer<UsbPacket> newest_;
  // Driver's thread.
  std::uint64_t last_read_{0};
  std::atomic<std::uint64_t> skipped_{0};
  // Bus's thread.
  UsbPacket arriving_{};
  Endings endings_;
};

class UsbMailboxes::OutPipe {
 public:
  explicit OutPipe(UsbDelivery delivery)
      : queue_(delivery == UsbDelivery::Every ? std::make_unique<Queue>() : nullptr) {}

  [[nodiscard]] bool is_queued() const noexcept { return queue_ != nullptr; }
  IoStatus submit(std::span<const std::uint8_t> bytes) noexcept {
    if (is_queued()) return append(bytes);
    const std::uint64_t arrived = arrived_.load(std::memory_order_relaxed);
    const bool is_way_free = arrived == submitted_.number || arrived != arrived_before_;
    arrived_before_ = arrived;
    std::copy(bytes.begin(), bytes.end(), submitted_.bytes.begin());
    submitted_.size = bytes.size();
    ++submitted_.number;
    newest_.write(submitted_);
    return is_way_free ? IoStatus::Ok : IoStatus::Backlogged;
  }
  std::span<const std::uint8_t> take(std::size_t nth) noexcept {
    if (is_queued()) return take_queued(nth);
    if (nth > 0) return {};
    if (owed_ == 0) {
      const std::uint64_t before = taken_.number;
      if (!newest_.read(taken_)) return {};
      superseded_.fetch_add(taken_.number - before - 1, std::memory_order_relaxed);
      owed_ = 1;
    }
    return {taken_.bytes.data(), taken_.size};
  }
  [[nodiscard]] bool has_any() const noexcept {
    if (is_queued()) return queue_->peek(0) != nullptr;
    return owed_ > 0 || newest_.has_news();
  }
  void finish(UsbOutcome outcome, std::size_t taken_bytes) noexcept {
    if (owed_ == 0 || (is_queued() && !queue_->pop(taken_))) return;
    --owed_;
    const bool is_whole = taken_bytes >= taken_.size;
    if (outcome == UsbOutcome::Done && !is_whole) cut_.fetch_add(1, std::memory_order_relaxed);
    endings_.add(outcome);
    // Only these count: a way out that fails every time must not look fresh to the servo.
    if (outcome != UsbOutcome::Done || !is_whole) return;
    arrived_.store(taken_.number, std::memory_order_relaxed);
  }
  void write_to(UsbCounters& counters) const noexcept {
    endings_.write_to(counters);
    counters.packets_out = endings_.done();
    counters.writes_superseded = superseded_.load(std::memory_order_relaxed);
    counters.writes_cut = cut_.load(std::memory_order_relaxed);
  }

 private:
  struct Packet {
    std::array<std::uint8_t, kMaxUsbPacketBytes> bytes{};
    std::size_t size{0};
    std::uint64_t number{0};  // 1 for the first submit
  };

  using Queue = rt::SpscRing<Packet, kUsbQueuedPackets>;

  std::span<const std::uint8_t> take_queued(std::size_t nth) noexcept {
    const Packet* const packet = queue_->peek(nth);
    if (packet == nullptr) return {};
    owed_ = std::max(owed_, nth + 1);
    return {packet->bytes.data(), packet->size};
  }
  IoStatus append(std::span<const std::uint8_t> bytes) noexcept {
    std::copy(bytes.begin(), bytes.end(), submitted_.bytes.begin());
    submitted_.size = bytes.size();
    ++submitted_.number;
    if (queue_->push(submitted_)) return IoStatus::Ok;
    --submitted_.number;
    return IoStatus::Backlogged;
  }

  std::unique_ptr<Queue> queue_;  // Every
  rt::TripleBuffer<Packet> newest_;
  // Driver's thread.
  Packet submitted_{};
  std::uint64_t arrived_before_{0};  // at the last submit
  // Bus's thread.
  Packet taken_{};
  std::size_t owed_{0};                    // ends of packets that were offered
  std::atomic<std::uint64_t> arrived_{0};  // number of the last packet the device took whole
  std::atomic<std::uint64_t> superseded_{0};
  std::atomic<std::uint64_t> cut_{0};
  Endings endings_;
};

class UsbMailboxes::Pipe {
 public:
  explicit Pipe(const UsbOpenPipe& description) : info_(description.info) {
    if (is_usb_in(info_.address)) {
      in_ = std::make_unique<InPipe>(description.pipe.delivery);
    } else {
      out_ = std::make_unique<OutPipe>(description.pipe.delivery);
    }
  }
  [[nodiscard]] const UsbEndpointInfo& info() const noexcept { return info_; }
  [[nodiscard]] InPipe* in() noexcept { return in_.get(); }     // nullptr: an OUT pipe
  [[nodiscard]] OutPipe* out() noexcept { return out_.get(); }  // nullptr: an IN pipe

 private:
  UsbEndpointInfo info_;
  std::unique_ptr<InPipe> in_;
  std::unique_ptr<OutPipe> out_;
};

UsbMailboxes::UsbMailboxes(std::span<const UsbOpenPipe> pipes) {
  for (const UsbOpenPipe& pipe : pipes) pipes_.push_back(std::make_unique<Pipe>(pipe));
}

UsbMailboxes::~UsbMailboxes() = default;

UsbMailboxes::Pipe* UsbMailboxes::find(std::uint8_t endpoint) const noexcept {
  for (const std::unique_ptr<Pipe>& pipe : pipes_) {
    if (pipe->info().address == endpoint) return pipe.get();
  }
  return nullptr;
}

const UsbEndpointInfo& UsbMailboxes::info(std::size_t pipe) const noexcept {
  return pipes_[pipe]->info();
}

bool UsbMailboxes::is_queued_out(std::size_t pipe) const noexcept {
  const OutPipe* out = pipes_[pipe]->out();
  return out != nullptr && out->is_queued();
}

IoStatus UsbMailboxes::read(std::uint8_t endpoint, UsbPacket& out) noexcept {
  if (is_disconnected()) return IoStatus::Disconnected;
  Pipe* pipe = find(endpoint);
  if (pipe == nullptr || pipe->in() == nullptr) return IoStatus::ProtocolError;
  return pipe->in()->read(out);
}

IoStatus UsbMailboxes::submit(std::uint8_t endpoint,
                              std::span<const std::uint8_t> packet) noexcept {
  if (is_disconnected()) return IoStatus::Disconnected;
  Pipe* pipe = find(endpoint);
  if (pipe == nullptr || pipe->out() == nullptr) return IoStatus::ProtocolError;
  if (packet.empty() || packet.size() > pipe->info().max_packet_bytes) {
    return IoStatus::ProtocolError;
  }
  return pipe->out()->submit(packet);
}

IoStatus UsbMailboxes::start_control(const UsbControlRequest& request) noexcept {
  if (is_disconnected()) return IoStatus::Disconnected;
  if (!may_be_sent(request)) return IoStatus::ProtocolError;
  if (is_reply_owed_) return IoStatus::Backlogged;
  is_reply_owed_ = true;
  requests_.write(request);
  return IoStatus::Ok;
}

IoStatus UsbMailboxes::read_control(UsbControlReply& out) noexcept {
  if (is_disconnected()) return IoStatus::Disconnected;
  if (!replies_.read(out)) return IoStatus::NoData;
  is_reply_owed_ = false;
  return IoStatus::Ok;
}

UsbCounters UsbMailboxes::counters(std::uint8_t endpoint) const noexcept {
  UsbCounters counters;
  if (endpoint == 0) {
    control_endings_.write_to(counters);
    counters.packets_out = control_endings_.done();
    return counters;
  }
  Pipe* pipe = find(endpoint);
  if (pipe == nullptr) return counters;
  if (pipe->in() != nullptr) pipe->in()->write_to(counters);
  if (pipe->out() != nullptr) pipe->out()->write_to(counters);
  return counters;
}

bool UsbMailboxes::has_out(std::size_t pipe) const noexcept {
  const OutPipe* out = pipes_[pipe]->out();
  return out != nullptr && out->has_any();
}

std::span<const std::uint8_t> UsbMailboxes::take_out(std::size_t pipe, std::size_t nth) noexcept {
  OutPipe* out = pipes_[pipe]->out();
  return out == nullptr ? std::span<const std::uint8_t>{} : out->take(nth);
}

void UsbMailboxes::finish_out(std::size_t pipe, UsbOutcome outcome, std::size_t taken) noexcept {
  if (OutPipe* out = pipes_[pipe]->out(); out != nullptr) out->finish(outcome, taken);
}

bool UsbMailboxes::finish_in(std::size_t pipe, UsbOutcome outcome,
                             std::span<const std::uint8_t> packet, MonotonicTime at) noexcept {
  InPipe* const in = pipes_[pipe]->in();
  return in == nullptr || in->finish(outcome, packet, at);
}

const UsbControlRequest* UsbMailboxes::take_control() noexcept {
  if (!is_request_open_) is_request_open_ = requests_.read(request_);
  return is_request_open_ ? &request_ : nullptr;
}

void UsbMailboxes::finish_control(const UsbControlReply& reply) noexcept {
  if (!is_request_open_) return;
  is_request_open_ = false;
  control_endings_.add(reply.outcome);
  replies_.write(reply);
}

}  // namespace thimble::bus
