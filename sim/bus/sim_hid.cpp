#include "sim/bus/sim_hid.hpp"

#include <algorithm>

#include "sim/bus/sim_hid_port.hpp"

namespace thimble::sim {

SimHid::SimHid(SimHidPort& port, std::uint64_t generation, std::size_t output_report_bytes) noexcept
    : port_(&port), generation_(generation), output_report_bytes_(output_report_bytes) {}

SimHid::~SimHid() { port_->detach(*this); }

IoStatus SimHid::read_newest(bus::HidReport& out) noexcept {
  if (port_->generation() != generation_) return IoStatus::Disconnected;
  if (!in_.read(out)) return IoStatus::NoData;
  reports_skipped_.fetch_add(out.sequence - last_read_ - 1, std::memory_order_relaxed);
  last_read_ = out.sequence;
  return IoStatus::Ok;
}

IoStatus SimHid::submit(std::span<const std::uint8_t> report) noexcept {
  if (port_->generation() != generation_) return IoStatus::Disconnected;
  if (report.empty() || report.size() != output_report_bytes_) return IoStatus::ProtocolError;
  const bool is_earlier_waiting = taken_.load(std::memory_order_relaxed) != submitted_;
  OutReport out;
  std::copy(report.begin(), report.end(), out.bytes.begin());
  out.size = report.size();
  out.number = ++submitted_;
  out_.write(out);
  return is_earlier_waiting ? IoStatus::Backlogged : IoStatus::Ok;
}

bus::HidCounters SimHid::counters() const noexcept {
  return {.reports_in = reports_in_.load(std::memory_order_relaxed),
          .reports_skipped = reports_skipped_.load(std::memory_order_relaxed),
          .reports_out = reports_out_.load(std::memory_order_relaxed),
          .writes_superseded = writes_superseded_.load(std::memory_order_relaxed)};
}

std::span<const std::uint8_t> SimHid::take_out() noexcept {
  if (!out_.read(taken_report_)) return {};
  const std::uint64_t before = taken_.load(std::memory_order_relaxed);
  writes_superseded_.fetch_add(taken_report_.number - before - 1, std::memory_order_relaxed);
  reports_out_.fetch_add(1, std::memory_order_relaxed);
  taken_.store(taken_report_.number, std::memory_order_relaxed);
  return {taken_report_.bytes.data(), taken_report_.size};
}

void SimHid::deliver(std::span<const std::uint8_t> report, MonotonicTime arrived_at) noexcept {
  bus::HidReport in;
  in.size = std::min(report.size(), in.bytes.size());
  std::copy_n(report.begin(), in.size, in.bytes.begin());
  in.arrived_at = arrived_at;
  in.sequence = reports_in_.fetch_add(1, std::memory_order_relaxed) + 1;
  in_.write(in);
}

}  // namespace thimble::sim
