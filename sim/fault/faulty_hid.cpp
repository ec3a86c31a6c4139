#include "sim/fault/faulty_hid.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace thimble::sim {
namespace {

bool is_blocked_write(const ScriptedFault& fault) {
  return fault.kind == FaultKind::Stall && fault.endpoint == kHidOut;
}

FaultPlan without_blocked_writes(FaultPlan plan) {
  std::erase_if(plan.script, is_blocked_write);
  return plan;
}

FaultPlan blocked_writes_of(const FaultPlan& plan) {
  FaultPlan blocked;
  std::copy_if(plan.script.begin(), plan.script.end(), std::back_inserter(blocked.script),
               is_blocked_write);
  return blocked;
}

}  // namespace

FaultyHid::FaultyHid(std::unique_ptr<bus::HidDevice> device, const Clock& clock,
                     const FaultPlan& plan, std::shared_ptr<FaultTally> tally)
    : device_(std::move(device)),
      clock_(&clock),
      dice_(without_blocked_writes(plan), tally),
      blocked_writes_(blocked_writes_of(plan), std::move(tally)) {}

FaultyHid::~FaultyHid() { dice_.tally().set_out_under_way(0); }

IoStatus FaultyHid::read_newest(bus::HidReport& out) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_disconnected(now)) return IoStatus::Disconnected;
  if (is_stalled(now)) {
    lose_stalled_input();
    return IoStatus::NoData;
  }
  if (!is_out_stalled(now)) {
    send_delayed(now);
    send_held(now);
  }

  bus::HidReport report;
  const IoStatus status = device_->read_newest(report);
  if (status == IoStatus::Disconnected) return status;
  if (status == IoStatus::Ok) take_in(report);
  const IoStatus handed = hand_over(out);
  return status == IoStatus::ProtocolError && handed == IoStatus::NoData ? status : handed;
}

IoStatus FaultyHid::submit(std::span<const std::uint8_t> report) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_disconnected(now)) return IoStatus::Disconnected;
  if (report.empty() || report.size() > bus::kMaxHidReportBytes) return IoStatus::ProtocolError;
  if (is_out_stalled(now)) {
    hold(report);
    return IoStatus::Backlogged;
  }
  send_delayed(now);
  const IoStatus status = send_or_delay(report, now, submitted_ + 1);
  if (status != IoStatus::Ok && status != IoStatus::Backlogged) return status;
  ++submitted_;
  if (held_.size != 0) superseded_here_.fetch_add(1, std::memory_order_relaxed);
  held_.size = 0;
  return status;
}

bus::HidCounters FaultyHid::counters() const noexcept {
  const std::uint64_t not_arrived = not_arrived_.load(std::memory_order_relaxed);
  const bus::HidCounters below = device_->counters();  // read last: never smaller
  return {.reports_in = below.reports_in - not_arrived,
          .reports_skipped = reports_skipped_.load(std::memory_order_relaxed),
          .reports_out = below.reports_out + dropped_out_.load(std::memory_order_relaxed),
          .writes_superseded =
              below.writes_superseded + superseded_here_.load(std::memory_order_relaxed)};
}

bool FaultyHid::is_disconnected(MonotonicTime now) noexcept {
  if (is_disconnected_ || !dice_.is_on(FaultKind::Disconnect, now)) return is_disconnected_;
  dice_.tally().add(FaultKind::Disconnect);
  is_disconnected_ = true;
  return true;
}

bool FaultyHid::is_stalled(MonotonicTime now) const noexcept {
  return now < stalled_until_ || dice_.is_on(FaultKind::Stall, now);
}

bool FaultyHid::is_out_stalled(MonotonicTime now) const noexcept {
  return is_stalled(now) || blocked_writes_.is_on(FaultKind::Stall, now);
}

void FaultyHid::lose_stalled_input() noexcept {
  bus::HidReport report;
  std::uint64_t lost = queue_size_;
  queue_size_ = 0;
  if (device_->read_newest(report) == IoStatus::Ok) {
    lost += report.sequence - seen_below_;
    seen_below_ = report.sequence;
  }
  lose(lost, FaultKind::Stall);
}

void FaultyHid::take_in(bus::HidReport& report) noexcept {
  const std::uint64_t number = report.sequence;
  seen_below_ = number;
  if (dice_.strikes_by_chance(FaultKind::Stall, number)) {
    stalled_until_ = clock_->now() + dice_.chances().stall_lasts;
    lose(1, FaultKind::Stall);
    return;
  }
  if (dice_.strikes(FaultKind::DropIn, report.arrived_at, number)) {
    lose(1, FaultKind::DropIn);
    return;
  }
  spoil(report, number);
  const Duration delay = dice_.delay_of(FaultKind::DelayIn, report.arrived_at, number);
  if (queue_size_ == kMaxDelayed) {
    lose(1, FaultKind::DropIn);
    return;
  }
  report.arrived_at = std::max(report.arrived_at + delay, last_arrival_);
  last_arrival_ = report.arrived_at;
  report.sequence = number - lost_;
  enqueue(report);
}

void FaultyHid::spoil(bus::HidReport& report, std::uint64_t number) noexcept {
  const std::span<std::uint8_t> bytes(report.bytes.data(), report.size);
  if (bytes.empty()) return;
  if (dice_.strikes(FaultKind::CorruptIn, report.arrived_at, number)) {
    dice_.corrupt(bytes, FaultKind::CorruptIn, number);
  }
  if (dice_.strikes(FaultKind::TruncateIn, report.arrived_at, number)) {
    report.size = dice_.cut(report.size, FaultKind::TruncateIn, number);
  }
}

void FaultyHid::enqueue(const bus::HidReport& report) noexcept {
  queue_[(queue_first_ + queue_size_) % kMaxDelayed] = report;
  ++queue_size_;
}

void FaultyHid::lose(std::uint64_t reports, FaultKind kind) noexcept {
  lost_ += reports;
  dice_.tally().add(kind, reports);
  publish_not_arrived();
}

void FaultyHid::publish_not_arrived() noexcept {
  not_arrived_.store(lost_ + queue_size_, std::memory_order_relaxed);
}

IoStatus FaultyHid::hand_over(bus::HidReport& out) noexcept {
  // Read again: a report may have arrived below after the tick began.
  const MonotonicTime now = clock_->now();
  IoStatus status = IoStatus::NoData;
  while (queue_size_ > 0 && queue_[queue_first_].arrived_at <= now) {
    out = queue_[queue_first_];
    queue_first_ = (queue_first_ + 1) % kMaxDelayed;
    --queue_size_;
    status = IoStatus::Ok;
  }
  publish_not_arrived();
  if (status != IoStatus::Ok) return status;
  reports_skipped_.fetch_add(out.sequence - last_read_ - 1, std::memory_order_relaxed);
  last_read_ = out.sequence;
  return status;
}

IoStatus FaultyHid::send(std::span<const std::uint8_t> report, MonotonicTime now,
                         std::uint64_t number) noexcept {
  if (dice_.injects(FaultKind::DropOut, now, number)) {
    dropped_out_.fetch_add(1, std::memory_order_relaxed);
    return IoStatus::Ok;
  }
  if (!dice_.strikes(FaultKind::CorruptOut, now, number)) {
    return device_->submit(report);
  }
  std::array<std::uint8_t, bus::kMaxHidReportBytes> bytes{};
  std::copy(report.begin(), report.end(), bytes.begin());
  dice_.corrupt({bytes.data(), report.size()}, FaultKind::CorruptOut, number);
  return device_->submit({bytes.data(), report.size()});
}

void FaultyHid::hold(std::span<const std::uint8_t> report) noexcept {
  if (held_.size != 0) superseded_here_.fetch_add(1, std::memory_order_relaxed);
  std::copy(report.begin(), report.end(), held_.bytes.begin());
  held_.size = report.size();
  held_.number = ++submitted_;
  dice_.tally().add(FaultKind::Stall);
}

void FaultyHid::send_held(MonotonicTime now) noexcept {
  if (held_.size == 0) return;
  send_or_delay({held_.bytes.data(), held_.size}, now, held_.number);
  held_.size = 0;
}

IoStatus FaultyHid::send_or_delay(std::span<const std::uint8_t> report, MonotonicTime now,
                                  std::uint64_t number) noexcept {
  const Duration delay = dice_.delay_of(FaultKind::DelayOut, now, number);
  if (delay <= Duration(0) && out_size_ == 0) return send(report, now, number);
  delay_out(report, now + delay, number);
  return IoStatus::Ok;
}

void FaultyHid::delay_out(std::span<const std::uint8_t> report, MonotonicTime leaves_at,
                          std::uint64_t number) noexcept {
  if (out_size_ > 0) {
    const OutReport& newest = out_queue_[(out_first_ + out_size_ - 1) % kMaxDelayed];
    leaves_at = std::max(leaves_at, newest.leaves_at);
  }
  if (out_size_ == kMaxDelayed) {
    --out_size_;
    superseded_here_.fetch_add(1, std::memory_order_relaxed);
  }
  OutReport& waiting = out_queue_[(out_first_ + out_size_) % kMaxDelayed];
  std::copy(report.begin(), report.end(), waiting.bytes.begin());
  waiting.size = report.size();
  waiting.number = number;
  waiting.leaves_at = leaves_at;
  dice_.tally().set_out_under_way(++out_size_);
}

void FaultyHid::send_delayed(MonotonicTime now) noexcept {
  if (out_size_ == 0) return;
  while (out_size_ > 0 && out_queue_[out_first_].leaves_at <= now) {
    const OutReport& report = out_queue_[out_first_];
    send({report.bytes.data(), report.size}, now, report.number);
    out_first_ = (out_first_ + 1) % kMaxDelayed;
    --out_size_;
  }
  dice_.tally().set_out_under_way(out_size_);
}

}  // namespace thimble::sim
