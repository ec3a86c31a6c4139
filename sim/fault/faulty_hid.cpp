#include "sim/fault/faulty_hid.hpp"

#include <algorithm>
#include <utility>

namespace thimble::sim {

FaultCounts FaultTally::read() const noexcept {
  FaultCounts counts;
  for (std::size_t i = 0; i < kFaultKindCount; ++i) {
    counts.by_kind[i] = by_kind_[i].load(std::memory_order_relaxed);
  }
  counts.out_under_way = out_under_way_.load(std::memory_order_relaxed);
  return counts;
}

FaultyHid::FaultyHid(std::unique_ptr<bus::HidDevice> device, const Clock& clock, FaultPlan plan,
                     std::shared_ptr<FaultTally> tally)
    : device_(std::move(device)),
      clock_(&clock),
      plan_(std::move(plan)),
      tally_(std::move(tally)) {}

FaultyHid::~FaultyHid() { tally_->set_out_under_way(0); }

IoStatus FaultyHid::read_newest(bus::HidReport& out) noexcept {
  const MonotonicTime now = clock_->now();
  if (is_disconnected(now)) return IoStatus::Disconnected;
  if (is_stalled(now)) {
    lose_stalled_input();
    return IoStatus::NoData;
  }
  send_delayed(now);
  send_held(now);

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
  if (is_stalled(now)) {
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
  if (is_disconnected_) return true;
  for (const ScriptedFault& fault : plan_.script) {
    if (fault.kind != FaultKind::Disconnect || !fault.covers(now)) continue;
    tally_->add(FaultKind::Disconnect);
    is_disconnected_ = true;
    return true;
  }
  return false;
}

bool FaultyHid::is_stalled(MonotonicTime now) const noexcept {
  if (now < stalled_until_) return true;
  return std::any_of(plan_.script.begin(), plan_.script.end(), [&](const ScriptedFault& fault) {
    return fault.kind == FaultKind::Stall && fault.covers(now);
  });
}

const ScriptedFault* FaultyHid::scripted(FaultKind kind, MonotonicTime t,
                                         std::uint64_t number) const noexcept {
  for (const ScriptedFault& fault : plan_.script) {
    if (fault.kind == kind && fault.covers(t) && fault.covers(number)) return &fault;
  }
  return nullptr;
}

bool FaultyHid::strikes(FaultKind kind, double chance, MonotonicTime t,
                        std::uint64_t number) const noexcept {
  if (scripted(kind, t, number) != nullptr) return true;
  return fault_strikes(fault_bits(plan_.seed, kind, number), chance);
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
  if (fault_strikes(fault_bits(plan_.seed, FaultKind::Stall, number), plan_.random.stall)) {
    stalled_until_ = clock_->now() + plan_.random.stall_lasts;
    lose(1, FaultKind::Stall);
    return;
  }
  if (strikes(FaultKind::DropIn, plan_.random.drop_in, report.arrived_at, number)) {
    lose(1, FaultKind::DropIn);
    return;
  }
  spoil(report, number);
  const Duration delay =
      delay_of(FaultKind::DelayIn, plan_.random.delay_in, report.arrived_at, number);
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
  if (strikes(FaultKind::CorruptIn, plan_.random.corrupt_in, report.arrived_at, number)) {
    corrupt(bytes, FaultKind::CorruptIn, number);
  }
  if (strikes(FaultKind::TruncateIn, plan_.random.truncate_in, report.arrived_at, number)) {
    report.size = fault_bits(plan_.seed + 1, FaultKind::TruncateIn, number) % report.size;
    tally_->add(FaultKind::TruncateIn);
  }
}

Duration FaultyHid::delay_of(FaultKind kind, double chance, MonotonicTime t,
                             std::uint64_t number) noexcept {
  Duration delay{};
  const ScriptedFault* fault = scripted(kind, t, number);
  if (fault != nullptr) delay = fault->delay;
  const std::uint64_t bits = fault_bits(plan_.seed, kind, number);
  const auto longest = static_cast<std::uint64_t>(plan_.random.max_delay.count());
  if (fault_strikes(bits, chance) && longest > 0) {
    const std::uint64_t length = fault_bits(plan_.seed + 1, kind, number) % longest;
    delay += Duration(static_cast<std::int64_t>(length + 1));
  }
  if (delay > Duration(0)) tally_->add(kind);
  return delay;
}

// One byte becomes another one: never a corruption that leaves the report as it was.
void FaultyHid::corrupt(std::span<std::uint8_t> bytes, FaultKind kind,
                        std::uint64_t number) noexcept {
  const std::uint64_t bits = fault_bits(plan_.seed + 1, kind, number);
  const auto change = static_cast<std::uint8_t>(1 + (bits >> 32U) % 255);
  std::uint8_t& byte = bytes[(bits & 0xffffffffU) % bytes.size()];
  byte = static_cast<std::uint8_t>(byte ^ change);
  tally_->add(kind);
}

void FaultyHid::enqueue(const bus::HidReport& report) noexcept {
  queue_[(queue_first_ + queue_size_) % kMaxDelayed] = report;
  ++queue_size_;
}

void FaultyHid::lose(std::uint64_t reports, FaultKind kind) noexcept {
  lost_ += reports;
  tally_->add(kind, reports);
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
  if (strikes(FaultKind::DropOut, plan_.random.drop_out, now, number)) {
    tally_->add(FaultKind::DropOut);
    dropped_out_.fetch_add(1, std::memory_order_relaxed);
    return IoStatus::Ok;
  }
  if (!strikes(FaultKind::CorruptOut, plan_.random.corrupt_out, now, number)) {
    return device_->submit(report);
  }
  std::array<std::uint8_t, bus::kMaxHidReportBytes> bytes{};
  std::copy(report.begin(), report.end(), bytes.begin());
  corrupt({bytes.data(), report.size()}, FaultKind::CorruptOut, number);
  return device_->submit({bytes.data(), report.size()});
}

void FaultyHid::hold(std::span<const std::uint8_t> report) noexcept {
  if (held_.size != 0) superseded_here_.fetch_add(1, std::memory_order_relaxed);
  std::copy(report.begin(), report.end(), held_.bytes.begin());
  held_.size = report.size();
  held_.number = ++submitted_;
  tally_->add(FaultKind::Stall);
}

void FaultyHid::send_held(MonotonicTime now) noexcept {
  if (held_.size == 0) return;
  send_or_delay({held_.bytes.data(), held_.size}, now, held_.number);
  held_.size = 0;
}

IoStatus FaultyHid::send_or_delay(std::span<const std::uint8_t> report, MonotonicTime now,
                                  std::uint64_t number) noexcept {
  const Duration delay = delay_of(FaultKind::DelayOut, plan_.random.delay_out, now, number);
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
  tally_->set_out_under_way(++out_size_);
}

void FaultyHid::send_delayed(MonotonicTime now) noexcept {
  if (out_size_ == 0) return;
  while (out_size_ > 0 && out_queue_[out_first_].leaves_at <= now) {
    const OutReport& report = out_queue_[out_first_];
    send({report.bytes.data(), report.size}, now, report.number);
    out_first_ = (out_first_ + 1) % kMaxDelayed;
    --out_size_;
  }
  tally_->set_out_under_way(out_size_);
}

}  // namespace thimble::sim
