#include "sim/bus/sim_hid_port.hpp"

#include <algorithm>
#include <array>
#include <thread>
#include <utility>

namespace thimble::sim {

SimHidPort::SimHidPort(VirtualClock& clock, bus::DeviceAddress address,
                       std::unique_ptr<plugin::SimHidModel> model)
    : clock_(&clock),
      model_(std::move(model)),
      info_(model_->describe()),
      frame_period_(model_->frame_period()) {
  info_.address = std::move(address);
  info_.kind = bus::BusKind::Hid;
  clock.events().schedule_at(*this, clock.now() + frame_period_);
}

bool SimHidPort::unplug() noexcept {
  if (!is_plugged()) return false;
  generation_.fetch_add(1, std::memory_order_release);
  SimHid* host = host_.load();
  if (host != nullptr) detach(*host);
  return true;
}

bool SimHidPort::replug() noexcept {
  if (is_plugged()) return false;
  generation_.fetch_add(1, std::memory_order_release);
  return true;
}

Result<std::unique_ptr<bus::HidDevice>> SimHidPort::open() {
  if (!is_plugged()) return fail(Errc::NotFound, info_.address.text + " is unplugged");
  if (host_.load() != nullptr) return fail(Errc::Busy, info_.address.text + " is open already");
  auto host = std::make_unique<SimHid>(*this, generation(), info_.output_report_bytes);
  host_.store(host.get());
  return host;
}

void SimHidPort::detach(SimHid& host) noexcept {
  SimHid* expected = &host;
  host_.compare_exchange_strong(expected, nullptr);
  while (in_frame_.load() == &host) std::this_thread::yield();
}

void SimHidPort::fire(MonotonicTime now) noexcept {
  const std::uint64_t current = generation();
  if (current != powered_generation_) model_->power_cycle();
  powered_generation_ = current;
  model_->advance(now);
  if (current % 2 != 0) {
    SimHid* host = host_.load();
    in_frame_.store(host);
    exchange(host_.load() == host ? host : nullptr, now);
    in_frame_.store(nullptr);
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
