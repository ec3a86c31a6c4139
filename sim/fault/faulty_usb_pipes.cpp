#include "sim/fault/faulty_usb_pipes.hpp"

#include <algorithm>

namespace thimble::sim {
namespace {

void count(std::atomic<std::uint64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}
std::uint64_t value(const std::atomic<std::uint64_t>& counter) noexcept {
  return counter.load(std::memory_order_relaxed);
}

}  // namespace

IoStatus FaultyUsbIn::read(bus::UsbDevice& device, bus::UsbPacket& out,
                           MonotonicTime now) noexcept {
  if (dice_.is_on(FaultKind::Stall, now)) {
    was_stalled_ = true;
    return IoStatus::NoData;
  }
  bus::UsbPacket packet;
  while (size_ < kMaxUnderWay) {
    const IoStatus status = device.read(pipe_.endpoint, packet);
    if (status == IoStatus::NoData) break;
    if (status != IoStatus::Ok) return status;
    // What the device could not get rid of during a stall arrives when it is over.
    if (was_stalled_) packet.arrived_at = std::max(packet.arrived_at, now);
    take_in(packet);
  }
  was_stalled_ = false;
  const IoStatus status = hand_over(out, now);
  not_arrived_.store(lost_ + size_, std::memory_order_relaxed);
  return status;
}

void FaultyUsbIn::take_in(bus::UsbPacket& packet) noexcept {
  const std::uint64_t number = packet.sequence;
  if (is_lost(packet)) {
    ++lost_;
    return;
  }
  const std::span<std::uint8_t> bytes(packet.bytes.data(), packet.size);
  if (!bytes.empty() && dice_.strikes(FaultKind::CorruptIn, packet.arrived_at, number)) {
    dice_.corrupt(bytes, FaultKind::CorruptIn, number);
  }
  if (!bytes.empty() && dice_.strikes(FaultKind::TruncateIn, packet.arrived_at, number)) {
    packet.size = dice_.cut(packet.size, FaultKind::TruncateIn, number);
  }
  Duration delay = dice_.delay_of(FaultKind::DelayIn, packet.arrived_at, number);
  if (dice_.strikes_by_chance(FaultKind::Stall, number)) {
    delay += dice_.chances().stall_lasts;
    dice_.tally().add(FaultKind::Stall);
  }
  packet.arrived_at = std::max(packet.arrived_at + delay, last_arrival_);
  last_arrival_ = packet.arrived_at;
  packet.sequence = number - lost_;
  queue_[(first_ + size_) % kMaxUnderWay] = packet;
  ++size_;
}

bool FaultyUsbIn::is_lost(const bus::UsbPacket& packet) noexcept {
  for (const FaultKind kind : {FaultKind::DropIn, FaultKind::Halt, FaultKind::Babble}) {
    if (!dice_.injects(kind, packet.arrived_at, packet.sequence)) continue;
    if (kind == FaultKind::Halt) count(halted_);
    if (kind == FaultKind::Babble) count(babbled_);
    return true;
  }
  return false;
}

IoStatus FaultyUsbIn::hand_over(bus::UsbPacket& out, MonotonicTime now) noexcept {
  IoStatus status = IoStatus::NoData;
  while (size_ > 0 && queue_[first_].arrived_at <= now) {
    out = queue_[first_];
    first_ = (first_ + 1) % kMaxUnderWay;
    --size_;
    status = IoStatus::Ok;
    if (pipe_.delivery == bus::UsbDelivery::Every) break;
  }
  if (status != IoStatus::Ok) return status;
  skipped_.fetch_add(out.sequence - last_read_ - 1, std::memory_order_relaxed);
  last_read_ = out.sequence;
  return status;
}

void FaultyUsbIn::correct(bus::UsbCounters& counters) const noexcept {
  counters.packets_in -= std::min(counters.packets_in, value(not_arrived_));
  counters.packets_skipped = value(skipped_);
  counters.stalls += value(halted_);
  counters.babbles += value(babbled_);
}

IoStatus FaultyUsbOut::submit(bus::UsbDevice& device, std::span<const std::uint8_t> bytes,
                              MonotonicTime now) noexcept {
  if (bytes.empty() || bytes.size() > info_.max_packet_bytes) return IoStatus::ProtocolError;
  if (is_queued_) return append(device, bytes, now);
  if (waiting_.size != 0) count(superseded_);
  wait_with(bytes);
  if (dice_.is_on(FaultKind::Stall, now)) dice_.tally().add(FaultKind::Stall);
  const bool has_last_failed = has_last_failed_;
  const IoStatus status = serve(device, now);
  const bool is_under_way = taken_.size != 0 || waiting_.size != 0;
  const bool is_free = !is_under_way && !has_last_failed;
  return status == IoStatus::Ok && !is_free ? IoStatus::Backlogged : status;
}

IoStatus FaultyUsbOut::append(bus::UsbDevice& device, std::span<const std::uint8_t> bytes,
                              MonotonicTime now) noexcept {
  if (dice_.is_on(FaultKind::Stall, now)) dice_.tally().add(FaultKind::Stall);
  const IoStatus status = serve(device, now);
  if (status != IoStatus::Ok) return status;
  if (waiting_.size != 0) return IoStatus::Backlogged;
  wait_with(bytes);
  return serve(device, now);
}

void FaultyUsbOut::wait_with(std::span<const std::uint8_t> bytes) noexcept {
  std::copy(bytes.begin(), bytes.end(), waiting_.bytes.begin());
  waiting_.size = bytes.size();
  waiting_.number = ++submitted_;
}

IoStatus FaultyUsbOut::serve(bus::UsbDevice& device, MonotonicTime now) noexcept {
  IoStatus status = IoStatus::Ok;
  if (dice_.is_on(FaultKind::Stall, now)) return status;
  while (taken_.size != 0 || waiting_.size != 0) {
    if (taken_.size == 0) {
      if (!may_pass(device)) break;
      taken_ = waiting_;
      waiting_.size = 0;
      const Duration delay = dice_.delay_of(FaultKind::DelayOut, now, taken_.number);
      taken_.leaves_at = now + delay;
      is_behind_late_one_ = delay > Duration(0);
    }
    if (now < taken_.leaves_at) break;
    status = pass(device, now);
    taken_.size = 0;
  }
  return status;
}

std::uint64_t FaultyUsbOut::below(const bus::UsbDevice& device) const noexcept {
  const bus::UsbCounters counters = device.counters(info_.address);
  return passed_ -
         (counters.packets_out + counters.writes_superseded + counters.stalls + counters.failures);
}

bool FaultyUsbOut::may_pass(const bus::UsbDevice& device) const noexcept {
  if (is_queued_) return below(device) < bus::kUsbQueuedPackets;
  // What was held up here must not be superseded below by what waited behind it.
  return !is_behind_late_one_ || below(device) == 0;
}

IoStatus FaultyUsbOut::pass(bus::UsbDevice& device, MonotonicTime now) noexcept {
  has_last_failed_ = false;
  if (dice_.injects(FaultKind::DropOut, now, taken_.number)) {
    count(swallowed_);
    return IoStatus::Ok;
  }
  if (dice_.injects(FaultKind::Halt, now, taken_.number)) {
    count(halted_);
    has_last_failed_ = true;
    return IoStatus::Ok;
  }
  const std::span<std::uint8_t> bytes(taken_.bytes.data(), taken_.size);
  if (dice_.strikes(FaultKind::CorruptOut, now, taken_.number)) {
    dice_.corrupt(bytes, FaultKind::CorruptOut, taken_.number);
  }
  std::size_t size = taken_.size;
  if (dice_.strikes(FaultKind::TruncateOut, now, taken_.number)) {
    size = dice_.cut(size, FaultKind::TruncateOut, taken_.number);
    count(cut_);
    has_last_failed_ = true;
  }
  if (size == 0) {
    count(swallowed_);
    return IoStatus::Ok;
  }
  ++passed_;
  return device.submit(info_.address, bytes.first(size));
}

void FaultyUsbOut::correct(bus::UsbCounters& counters) const noexcept {
  counters.packets_out += value(swallowed_);
  counters.writes_superseded += value(superseded_);
  counters.writes_cut += value(cut_);
  counters.stalls += value(halted_);
}

IoStatus FaultyUsbControl::start(bus::UsbDevice& device, const bus::UsbControlRequest& request,
                                 MonotonicTime now) noexcept {
  if (!bus::may_be_sent(request)) return IoStatus::ProtocolError;
  if (state_ != State::Idle) return IoStatus::Backlogged;
  request_ = request;
  leaves_at_ = now + dice_.delay_of(FaultKind::DelayOut, now, ++started_);
  if (dice_.is_on(FaultKind::Stall, now)) dice_.tally().add(FaultKind::Stall);
  state_ = State::Held;
  return serve(device, now);
}

IoStatus FaultyUsbControl::serve(bus::UsbDevice& device, MonotonicTime now) noexcept {
  if (state_ != State::Held || now < leaves_at_) return IoStatus::Ok;
  if (dice_.is_on(FaultKind::Stall, now)) return IoStatus::Ok;
  if (dice_.injects(FaultKind::DropOut, now, started_)) {
    state_ = State::Lost;
    return IoStatus::Ok;
  }
  if (dice_.injects(FaultKind::Halt, now, started_)) {
    state_ = State::Refused;
    return IoStatus::Ok;
  }
  const bool has_data = request_.length > 0 && !bus::asks_for_data(request_);
  if (has_data && dice_.strikes(FaultKind::CorruptOut, now, started_)) {
    dice_.corrupt({request_.data.data(), request_.length}, FaultKind::CorruptOut, started_);
  }
  state_ = State::Below;
  return device.start_control(request_);
}

IoStatus FaultyUsbControl::read(bus::UsbDevice& device, bus::UsbControlReply& out,
                                MonotonicTime now) noexcept {
  if (state_ == State::Refused) {
    out = {.outcome = bus::UsbOutcome::Stalled};
    state_ = State::Idle;
    count(refused_);
    return IoStatus::Ok;
  }
  bus::UsbControlReply reply;
  if (dice_.is_on(FaultKind::Stall, now)) return IoStatus::NoData;
  const IoStatus status = device.read_control(reply);
  if (status != IoStatus::Ok) return status;
  if (reply.outcome == bus::UsbOutcome::Done && is_spoilt(reply, now)) {
    state_ = State::Lost;
    return IoStatus::NoData;
  }
  state_ = State::Idle;
  out = reply;
  return IoStatus::Ok;
}

// True when the answer never comes.
bool FaultyUsbControl::is_spoilt(bus::UsbControlReply& reply, MonotonicTime now) noexcept {
  if (dice_.injects(FaultKind::DropIn, now, started_)) {
    count(unanswered_);
    return true;
  }
  if (!bus::asks_for_data(request_) || reply.size == 0) return false;
  if (dice_.injects(FaultKind::Babble, now, started_)) {
    count(babbled_);
    reply = {.outcome = bus::UsbOutcome::Babbled};
    return false;
  }
  if (dice_.strikes(FaultKind::CorruptIn, now, started_)) {
    dice_.corrupt({reply.data.data(), reply.size}, FaultKind::CorruptIn, started_);
  }
  if (dice_.strikes(FaultKind::TruncateIn, now, started_)) {
    reply.size = dice_.cut(reply.size, FaultKind::TruncateIn, started_);
  }
  return false;
}

void FaultyUsbControl::correct(bus::UsbCounters& counters) const noexcept {
  const std::uint64_t not_done = value(babbled_) + value(unanswered_);
  counters.packets_out -= std::min(counters.packets_out, not_done);
  counters.stalls += value(refused_);
  counters.babbles += value(babbled_);
}

}  // namespace thimble::sim
