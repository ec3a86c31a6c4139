#include "sim/export/uhid_plug.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "hal/linux/system_error.hpp"

namespace thimble::sim {
namespace {

// Ours: twice the kernel's queue, which has 32 (UHID_BUFSIZE, drivers/hid/uhid.c), so that a host
// that goes on writing does not hold a frame up.
constexpr int kMostEventsOfAFrame = 64;

}  // namespace

UhidPlug::UhidPlug(linux::Descriptor node, plugin::SimHidModel& model, bus::BusDeviceInfo info,
                   const PlugSurroundings& surroundings)
    : node_(std::move(node)),
      model_(&model),
      info_(std::move(info)),
      descriptor_(model.report_descriptor()),
      around_(surroundings) {
  around_.clock->events().schedule_at(*this, around_.clock->now() + model_->frame_period());
}

Result<void> UhidPlug::plug() {
  if (is_plugged_) return fail(Errc::Busy, "it is plugged in already");
  if (!write_event(uhid::create(info_, descriptor_))) {
    return tl::unexpected(linux::system_error("uhid: UHID_CREATE2", errno));
  }
  if (has_no_supply_) model_->power_cycle();
  is_plugged_ = true;
  return {};
}

Result<void> UhidPlug::unplug(Supply supply) {
  const bool has_news = is_plugged_ || (supply == Supply::Goes && !has_no_supply_);
  if (!has_news) return fail(Errc::NotFound, "it is not plugged in");
  if (is_plugged_ && !write_event(uhid::destroy())) {
    return tl::unexpected(linux::system_error("uhid: UHID_DESTROY", errno));
  }
  is_plugged_ = false;
  is_open_ = false;
  has_output_ = false;
  endpoint_bytes_ = 0;  // a device that is not addressed has no report to give
  has_no_supply_ = supply == Supply::Goes;
  if (has_no_supply_) model_->power_cycle();
  return {};
}

void UhidPlug::fire(MonotonicTime now) noexcept {
  model_->advance(now);
  take_events(now);
  const bool is_silent = around_.misbehaviour->is_silent(now);
  if (is_plugged_ && !is_silent) {
    give_output(now);
    send_input(now);
  }
  if (is_plugged_ && is_silent && is_open_) around_.misbehaviour->note_unanswered();
  plugin::ArmBackend* arm = model_->arm_backend();
  if (arm != nullptr) around_.log->note_sample(around_.time(now), arm->truth());
  around_.clock->events().schedule_at(*this, now + model_->frame_period());
}

bool UhidPlug::read_event() {
  event_.fill(0);  // short events are to be extended with zeros
  const ssize_t got = ::read(node_.get(), event_.data(), event_.size());
  if (got > 0) return true;
  if (got == 0 || (errno != EAGAIN && errno != EINTR)) is_broken_ = true;
  return false;
}

void UhidPlug::take_events(MonotonicTime now) {
  for (int i = 0; i < kMostEventsOfAFrame && !is_broken_ && read_event(); ++i) {
    const std::optional<uhid::Event> event = uhid::parse(event_);
    if (event) {
      take(*event, now);
    } else {
      ++counters_.malformed;
    }
  }
}

void UhidPlug::take(const uhid::Event& event, MonotonicTime now) {
  // What was queued before the last unplug may come after it.
  if (!is_plugged_) return;
  if (std::holds_alternative<uhid::Open>(event)) is_open_ = true;
  if (std::holds_alternative<uhid::Close>(event)) is_open_ = false;
  if (const auto* output = std::get_if<uhid::Output>(&event)) note_output(*output);
  if (const auto* get = std::get_if<uhid::GetReport>(&event)) answer(*get, now);
  if (const auto* set = std::get_if<uhid::SetReport>(&event)) answer(*set, now);
}

std::span<const std::uint8_t> UhidPlug::without_number(
    std::span<const std::uint8_t> bytes) const noexcept {
  const bool has_zero = !info_.has_report_ids && !bytes.empty() && bytes.front() == 0;
  return has_zero ? bytes.subspan(1) : bytes;
}

void UhidPlug::note_output(const uhid::Output& output) {
  if (has_output_) ++counters_.superseded;
  const bool is_as_written =
      output.bytes.size() == info_.output_report_bytes;  // by a driver in the kernel
  const auto bytes = is_as_written ? output.bytes : without_number(output.bytes);
  std::copy(bytes.begin(), bytes.end(), output_.begin());
  output_bytes_ = bytes.size();
  has_output_ = true;
}

void UhidPlug::give_output(MonotonicTime now) {
  if (!std::exchange(has_output_, false)) return;
  if (around_.misbehaviour->refuses(now)) {
    ++counters_.lost;
    return;
  }
  const auto written = std::span(output_).first(output_bytes_);
  const auto report = around_.misbehaviour->taken_of(written);
  around_.misbehaviour->note_taken(written);
  around_.log->note_bytes(around_.time(now), ModelLog::Direction::ToModel, report);
  model_->out_report(report);
  ++counters_.from_host;
}

void UhidPlug::send_input(MonotonicTime now) {
  if (endpoint_bytes_ == 0)
    endpoint_bytes_ = std::min(model_->in_report(endpoint_), endpoint_.size());
  if (endpoint_bytes_ == 0 || !is_open_ || around_.misbehaviour->refuses(now)) return;
  const std::size_t size =
      std::min(around_.misbehaviour->spoil(endpoint_, endpoint_bytes_), endpoint_.size());
  const std::span<const std::uint8_t> report(endpoint_.data(), size);
  endpoint_bytes_ = 0;
  if (report.empty()) return;
  around_.log->note_bytes(around_.time(now), ModelLog::Direction::ToHost, report);
  if (write_event(uhid::input(report))) {
    ++counters_.to_host;
  } else {
    ++counters_.lost;
  }
}

void UhidPlug::answer(const uhid::GetReport& request, MonotonicTime now) {
  ++counters_.requests;
  std::array<std::uint8_t, bus::kMaxHidReportBytes + 1> report{};
  // The kernel keeps a byte for the number that is not there.
  const std::size_t prefix = info_.has_report_ids ? 0 : 1;
  const bool is_refused = around_.misbehaviour->refuses(now);
  const std::span<std::uint8_t> room(report.data() + prefix, bus::kMaxHidReportBytes);
  std::size_t size = is_refused ? 0 : model_->get_report(request.kind, request.number, room);
  size = std::min(size, room.size());
  if (size > 0) size = std::min(around_.misbehaviour->spoil(room, size), room.size());
  if (size == 0) {
    write_event(uhid::get_report_reply(request.id, EPIPE, {}));
    return;
  }
  write_event(uhid::get_report_reply(request.id, 0, {report.data(), prefix + size}));
}

void UhidPlug::answer(const uhid::SetReport& request, MonotonicTime now) {
  ++counters_.requests;
  const std::span<const std::uint8_t> report = without_number(request.bytes);
  around_.log->note_bytes(around_.time(now), ModelLog::Direction::Requested, report);
  const bool is_taken =
      !around_.misbehaviour->refuses(now) && model_->set_report(request.kind, report);
  write_event(uhid::set_report_reply(request.id, is_taken ? 0 : EPIPE));
}

bool UhidPlug::write_event(std::span<const std::uint8_t> bytes) {
  return ::write(node_.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
}

}  // namespace thimble::sim
