#include "sim/bus/sim_hid_port.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace thimble::sim {

SimHidPort::SimHidPort(VirtualClock& clock, bus::DeviceAddress address,
                       std::unique_ptr<plugin::SimHidModel> model)
    : SimPort(model->describe(), std::move(address), bus::BusKind::Hid),
      clock_(&clock),
      model_(std::move(model)),
      frame_period_(model_->frame_period()) {
  clock.events().schedule_at(*this, clock.now() + frame_period_);
}

void SimHidPort::drop_host() noexcept {
  SimHid* host = host_.host();
  if (host != nullptr) host_.detach(*host);
}

Result<std::unique_ptr<bus::HidDevice>> SimHidPort::open_hid() {
  const Result<void> free = check_free(host_.is_taken());
  if (!free.has_value()) return tl::unexpected(free.error());
  auto host = std::make_unique<SimHid>(*this, generation(), info().output_report_bytes);
  host_.attach(*host);
  return host;
}

void SimHidPort::fire(MonotonicTime now) noexcept {
  if (advance(*model_, now)) {
    host_.visit([&](SimHid* host) { exchange(host, now); });
  }
  clock_->events().schedule_at(*this, now + frame_period_);
}

void SimHidPort::exchange(SimHid* host, MonotonicTime now) noexcept {
  if (host != nullptr) {
    const std::span<const std::uint8_t> out = host->take_out();
    if (!out.empty()) model_->out_report(out);
  }
  // A device that nobody opened fills its endpoint all the same.
  std::array<std::uint8_t, bus::kMaxHidReportBytes> in{};
  const std::size_t size = std::min(model_->in_report(in), in.size());
  if (host != nullptr && size > 0) host->deliver({in.data(), size}, now);
}

}  // namespace thimble::sim
