#include "sim/fault/faulty_usb.hpp"

#include <utility>

namespace thimble::sim {
namespace {

// What of a plan concerns one endpoint, with chances of its own.
FaultPlan plan_of(const FaultPlan& plan, std::uint8_t endpoint) {
  constexpr unsigned kAboveEverySeed = 56;  // seeds count upwards, so that they do not meet
  FaultPlan own = plan;
  own.seed ^= static_cast<std::uint64_t>(endpoint) << kAboveEverySeed;
  std::erase_if(own.script, [&](const ScriptedFault& fault) {
    return fault.endpoint.has_value() && fault.endpoint != endpoint;
  });
  return own;
}

}  // namespace

FaultyUsb::FaultyUsb(std::unique_ptr<bus::UsbDevice> device,
                     std::span<const bus::UsbOpenPipe> pipes, const Clock& clock,
                     const FaultPlan& plan, const std::shared_ptr<FaultTally>& tally)
    : device_(std::move(device)),
      clock_(&clock),
      dice_(plan, tally),
      control_(FaultDice(plan_of(plan, 0), tally)) {
  for (const bus::UsbOpenPipe& pipe : pipes) {
    FaultDice dice(plan_of(plan, pipe.info.address), tally);
    if (bus::is_usb_in(pipe.info.address)) {
      ins_.push_back(std::make_unique<FaultyUsbIn>(pipe.pipe, std::move(dice)));
    } else {
      outs_.push_back(std::make_unique<FaultyUsbOut>(pipe, std::move(dice)));
    }
  }
}

bool FaultyUsb::serve(MonotonicTime now) noexcept {
  if (!is_disconnected_ && dice_.is_on(FaultKind::Disconnect, now)) {
    dice_.tally().add(FaultKind::Disconnect);
    is_disconnected_ = true;
  }
  if (is_disconnected_) return false;
  latched(control_.serve(*device_, now));
  for (const std::unique_ptr<FaultyUsbOut>& out : outs_) latched(out->serve(*device_, now));
  return !is_disconnected_;
}

IoStatus FaultyUsb::latched(IoStatus status) noexcept {
  if (status == IoStatus::Disconnected) is_disconnected_ = true;
  return status;
}

IoStatus FaultyUsb::read(std::uint8_t endpoint, bus::UsbPacket& out) noexcept {
  const MonotonicTime now = clock_->now();
  if (!serve(now)) return IoStatus::Disconnected;
  for (const std::unique_ptr<FaultyUsbIn>& in : ins_) {
    if (in->endpoint() == endpoint) return latched(in->read(*device_, out, now));
  }
  return latched(device_->read(endpoint, out));
}

IoStatus FaultyUsb::submit(std::uint8_t endpoint, std::span<const std::uint8_t> packet) noexcept {
  const MonotonicTime now = clock_->now();
  if (!serve(now)) return IoStatus::Disconnected;
  for (const std::unique_ptr<FaultyUsbOut>& out : outs_) {
    if (out->endpoint() == endpoint) return latched(out->submit(*device_, packet, now));
  }
  return latched(device_->submit(endpoint, packet));
}

IoStatus FaultyUsb::start_control(const bus::UsbControlRequest& request) noexcept {
  const MonotonicTime now = clock_->now();
  if (!serve(now)) return IoStatus::Disconnected;
  return latched(control_.start(*device_, request, now));
}

IoStatus FaultyUsb::read_control(bus::UsbControlReply& out) noexcept {
  const MonotonicTime now = clock_->now();
  if (!serve(now)) return IoStatus::Disconnected;
  return latched(control_.read(*device_, out, now));
}

bus::UsbCounters FaultyUsb::counters(std::uint8_t endpoint) const noexcept {
  bus::UsbCounters counters = device_->counters(endpoint);
  if (endpoint == 0) control_.correct(counters);
  for (const std::unique_ptr<FaultyUsbIn>& in : ins_) {
    if (in->endpoint() == endpoint) in->correct(counters);
  }
  for (const std::unique_ptr<FaultyUsbOut>& out : outs_) {
    if (out->endpoint() == endpoint) out->correct(counters);
  }
  return counters;
}

}  // namespace thimble::sim
