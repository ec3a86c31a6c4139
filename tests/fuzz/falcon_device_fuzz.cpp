#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>

#include "drivers/falcon/falcon_device.hpp"
#include "drivers/falcon/find_model.hpp"

// This program links no limiter: here the friend of LimitedWrench only makes wrenches.
namespace thimble::servo {
class WrenchLimiter {
 public:
  static LimitedWrench make(Force3 force) { return LimitedWrench(force); }
};
}  // namespace thimble::servo

namespace {

using namespace thimble;

// As late as the bridge says.
class WireClock final : public Clock {
 public:
  [[nodiscard]] MonotonicTime now() const noexcept override { return now_; }
  Duration sleep_until(MonotonicTime deadline) noexcept override {
    now_ = std::max(now_, deadline);
    return {};
  }

 private:
  MonotonicTime now_{std::chrono::seconds(1)};
};

// A bridge that says what the input says, and looks at what is sent to the motors.
class HostileBridge final : public bus::UsbDevice {
 public:
  HostileBridge(std::span<const std::uint8_t>& rest, WireClock& clock)
      : rest_(rest), clock_(clock) {}
  IoStatus read(std::uint8_t, bus::UsbPacket& out) noexcept override {
    if (rest_.size() < 2 || has_spoken_) return IoStatus::NoData;
    has_spoken_ = true;
    clock_.sleep_until(clock_.now() + (rest_[0] & 0x7FU) * std::chrono::milliseconds(1));
    if (rest_[0] > 0x7F) {  // time that passes without a packet
      rest_ = rest_.subspan(1);
      return IoStatus::NoData;
    }
    out.size = std::min<std::size_t>({rest_[1] % 65U, rest_.size() - 2, out.bytes.size()});
    std::copy_n(rest_.begin() + 2, out.size, out.bytes.begin());
    out.arrived_at = clock_.now();
    out.sequence = ++sequence_;
    rest_ = rest_.subspan(2 + out.size);
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t, std::span<const std::uint8_t> packet) noexcept override {
    falcon::RunParser parser;
    for (const std::uint8_t byte : packet) {
      const auto sent = parser.take(byte);
      if (!sent) continue;
      for (const int counts : sent->encoder_counts) {
        if (std::abs(counts) > falcon::wire::kMaxMotor_counts) std::abort();
        if (counts != 0 && !may_push) std::abort();
      }
    }
    return IoStatus::Ok;
  }
  IoStatus start_control(const bus::UsbControlRequest&) noexcept override {
    is_asked_ = true;
    return IoStatus::Ok;
  }
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    has_spoken_ = false;  // asked once a tick
    if (!std::exchange(is_asked_, false)) return IoStatus::NoData;
    out.outcome = bus::UsbOutcome::Done;
    return IoStatus::Ok;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t) const noexcept override { return {}; }

  bool may_push{false};  // the newest state was one of a homed arm

 private:
  std::span<const std::uint8_t>& rest_;
  WireClock& clock_;
  std::uint64_t sequence_{0};
  bool is_asked_{false};
  bool has_spoken_{false};
};

}  // namespace

// Whatever an arm says: its state is finite, its motors are told nothing beyond their range, and
// nothing at all unless it said that it is homed. Of each packet: milliseconds since the one
// before, up to 127, its length, its bytes; a byte above 127 is 0 to 127 ms without a packet.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> rest(data, size);
  const falcon::FalconModel& model = *falcon::find_model("falcon");
  WireClock clock;
  auto bridge = std::make_unique<HostileBridge>(rest, clock);
  HostileBridge& wire = *bridge;
  falcon::FalconDevice arm(std::move(bridge), model, {model.newton_per_count, {}, &clock});
  const LimitedWrench push = servo::WrenchLimiter::make({1e6, -1e6, 1e6});
  for (int tick = 0; tick < 20 || (rest.size() >= 2 && tick < 4000); ++tick) {
    HapticState state;
    if (arm.read(state) == IoStatus::Ok) {
      wire.may_push = state.calibration == CalibrationState::Ok;
      if (!is_finite(state.tip)) std::abort();
      for (const auto& row : state.motor_current_per_force.row) {
        for (const double share : row) {
          if (!std::isfinite(share)) std::abort();
        }
      }
    }
    static_cast<void>(arm.write(push));
  }
  return 0;
}
