#include "drivers/phantom/text_link.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "hal/bus/usb_device.hpp"

namespace thimble::phantom {
namespace {

using Count = std::int16_t;  // what the driver's counters are, whatever the firmware

bool fits(std::int32_t counts) noexcept {
  return counts >= std::numeric_limits<Count>::min() && counts <= std::numeric_limits<Count>::max();
}

}  // namespace

TextLink::TextLink(std::unique_ptr<bus::SerialPort> port, const PhantomModel& model,
                   double amplifier_max_a, const Clock& clock)
    : port_(std::move(port)),
      amplifier_max_a_(amplifier_max_a),
      build_number_(text::build_number(model.name).value_or(0)),
      other_arm_("The controller says that it drives another arm than " + std::string(model.name) +
                 ": correct the arm's model in the configuration"),
      clock_(&clock) {}

TextLink::~TextLink() {
  static_cast<void>(port_->submit(encode_text_currents({}, amplifier_max_a_).payload()));
}

// No more chunks than the queue holds: a device that floods it does not hold the tick.
IoStatus TextLink::read(ControllerReport& out) noexcept {
  is_fresh_ = false;
  is_disturbed_ = false;
  const std::uint64_t lost_before = lines_.lost_bytes();
  for (std::size_t i = 0; i < bus::kUsbQueuedPackets; ++i) {
    const IoStatus status = port_->read(chunk_);
    if (status == IoStatus::Disconnected) return status;
    if (status != IoStatus::Ok) break;
    take_chunk();
  }
  is_disturbed_ = is_disturbed_ || lines_.lost_bytes() != lost_before;
  if (is_disturbed_) malformed_.fetch_add(1, std::memory_order_relaxed);
  if (!is_fresh_) return is_disturbed_ ? IoStatus::ProtocolError : IoStatus::NoData;
  out = newest_;
  return IoStatus::Ok;
}

void TextLink::take_chunk() noexcept {
  if (chunk_.sequence != last_chunk_ + 1) {
    lines_.forget();
    jump_.forget();
  }
  last_chunk_ = chunk_.sequence;
  for (const std::uint8_t byte : chunk_.payload()) {
    const std::span<const std::uint8_t> line = lines_.take(byte);
    if (!line.empty()) take_line(line);
  }
}

void TextLink::take_line(std::span<const std::uint8_t> line) noexcept {
  if (answers_owed_ > 0) --answers_owed_;
  const std::optional<TextReport> report = parse_text_report(line);
  const bool is_good = report && (report->error & ~text::kErrorGimbal) == 0 &&
                       std::all_of(report->counts.begin(), report->counts.end(), fits);
  if (is_good) {
    is_other_arm_.store(report->model != build_number_, std::memory_order_relaxed);
  }
  if (!is_good || report->model != build_number_) {
    is_disturbed_ = true;
    return;
  }
  const Duration since_last =
      newest_.sequence == 0 ? Duration(0) : chunk_.arrived_at - newest_.arrived_at;
  const ZeroJump::Counts counts{report->counts[0], report->counts[1], report->counts[2]};
  jump_.on_counts(counts, since_last);
  is_press_unseen_.store(ZeroJump::is_unseen_at(counts), std::memory_order_relaxed);
  if (is_fresh_) skipped_.fetch_add(1, std::memory_order_relaxed);
  is_fresh_ = true;
  newest_ = {.values = {},
             .arrived_at = chunk_.arrived_at,
             .sequence = reports_.fetch_add(1, std::memory_order_relaxed) + 1};
  for (std::size_t i = 0; i < 3; ++i) {
    newest_.values.base_counts[i] = static_cast<Count>(report->counts[i]);
    newest_.values.gimbal_counts[i] = static_cast<Count>(report->counts[3 + i]);
  }
  newest_.values.is_calibration_pressed = jump_.is_pressed();
}

IoStatus TextLink::write_currents(const std::array<double, 3>& current_a) noexcept {
  const MonotonicTime now = clock_->now();
  if (now - asked_at_ >= kPatience) answers_owed_ = 0;
  const bool is_current = current_a != std::array<double, 3>{};
  const bool overtakes = is_current_sent_ && !is_current;
  if (answers_owed_ > 0 && !overtakes) return IoStatus::Backlogged;
  const IoStatus status =
      port_->submit(encode_text_currents(current_a, amplifier_max_a_).payload());
  if (status != IoStatus::Ok && status != IoStatus::Backlogged) return status;
  // Backlogged: it may have taken the place of the one before, which then has no answer.
  answers_owed_ = status == IoStatus::Ok ? answers_owed_ + 1 : 1;
  is_current_sent_ = is_current;
  asked_at_ = now;
  return status;
}

// The press has zeroed them; what is left is to lower the flag that we made of it.
IoStatus TextLink::zero_counters() noexcept {
  jump_.lower();
  return write_currents({});
}

ZeroCommand TextLink::zero_command() const noexcept {
  ZeroCommand zero;
  const TextMessage message = encode_text_currents({}, amplifier_max_a_);
  for (const std::uint8_t byte : message.payload()) zero.bytes.push_back(byte);
  return zero;
}

DeviceCounters TextLink::counters() const noexcept {
  const bus::SerialCounters on_bus = port_->counters();
  DeviceCounters counters;
  counters.reports_in = reports_.load(std::memory_order_relaxed);
  counters.reports_skipped = skipped_.load(std::memory_order_relaxed);
  counters.malformed = malformed_.load(std::memory_order_relaxed);
  counters.commands_out = on_bus.messages_out;
  counters.commands_superseded = on_bus.writes_superseded;
  return counters;
}

std::string_view TextLink::trouble() const noexcept {
  return is_other_arm_.load(std::memory_order_relaxed) ? std::string_view(other_arm_)
                                                       : std::string_view{};
}

}  // namespace thimble::phantom
