#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>

#include "drivers/falcon/falcon_device.hpp"
#include "drivers/falcon/find_model.hpp"
#include "tests/fuzz/device_under_fuzz.hpp"

namespace {

using namespace thimble;

// A bridge that says what the input says, and looks at what is sent to the motors.
class HostileBridge final : public bus::UsbDevice {
 public:
  HostileBridge(fuzz::WireScript& script, fuzz::WireClock& clock)
      : script_(script), clock_(clock) {}
  IoStatus read(std::uint8_t, bus::UsbPacket& out) noexcept override {
    if (is_gone_) return IoStatus::Disconnected;
    if (has_spoken_) return IoStatus::NoData;
    has_spoken_ = true;
    const fuzz::WireEvent event = script_.next(clock_, out.bytes, out.size);
    if (event == fuzz::WireEvent::Trouble) meet_trouble();
    if (event != fuzz::WireEvent::Packet) {
      return is_gone_ ? IoStatus::Disconnected : IoStatus::NoData;
    }
    out.arrived_at = clock_.now();
    out.sequence = ++sequence_;
    return IoStatus::Ok;
  }
  IoStatus submit(std::uint8_t, std::span<const std::uint8_t> packet) noexcept override {
    falcon::RunParser parser;
    for (const std::uint8_t byte : packet) {
      const auto sent = parser.take(byte);
      if (!sent) continue;
      for (const int counts : sent->encoder_counts) {
        THIMBLE_CHECK(std::abs(counts) <= falcon::wire::kMaxMotor_counts);
        THIMBLE_CHECK(counts == 0 || may_push);
      }
    }
    return is_gone_ ? IoStatus::Disconnected : IoStatus::Ok;
  }
  IoStatus start_control(const bus::UsbControlRequest&) noexcept override {
    is_asked_ = true;
    return is_gone_ ? IoStatus::Disconnected : IoStatus::Ok;
  }
  IoStatus read_control(bus::UsbControlReply& out) noexcept override {
    has_spoken_ = false;  // asked once a tick
    if (is_gone_) return IoStatus::Disconnected;
    if (is_mute_ || !std::exchange(is_asked_, false)) return IoStatus::NoData;
    out.outcome = std::exchange(outcome_, bus::UsbOutcome::Done);
    return IoStatus::Ok;
  }
  [[nodiscard]] bus::UsbCounters counters(std::uint8_t) const noexcept override { return {}; }

  bool may_push{false};  // the newest state was one of a homed arm

 private:
  // Gone is gone for good; a request may be refused, or never end.
  void meet_trouble() noexcept {
    if (script_.trouble == fuzz::WireTrouble::Disconnected) is_gone_ = true;
    if (script_.trouble == fuzz::WireTrouble::Refused) outcome_ = bus::UsbOutcome::Stalled;
    if (script_.trouble == fuzz::WireTrouble::Broken) outcome_ = bus::UsbOutcome::Failed;
    if (script_.trouble == fuzz::WireTrouble::Silent) is_mute_ = !is_mute_;
  }

  fuzz::WireScript& script_;
  fuzz::WireClock& clock_;
  std::uint64_t sequence_{0};
  bus::UsbOutcome outcome_{bus::UsbOutcome::Done};
  bool is_asked_{false};
  bool is_mute_{false};
  bool has_spoken_{false};
  bool is_gone_{false};
};

}  // namespace

// Whatever an arm says, or leaves unsaid: its state is finite, its motors are told nothing beyond
// their range, and nothing at all unless it said that it is homed; one that is given up stays so.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::WireScript script({data, size});
  const falcon::FalconModel& model = *falcon::find_model("falcon");
  fuzz::WireClock clock;
  auto bridge = std::make_unique<HostileBridge>(script, clock);
  HostileBridge& wire = *bridge;
  falcon::FalconDevice arm(std::move(bridge), model, {model.newton_per_count, {}, &clock});
  bool is_given_up = false;
  for (int tick = 0; script.goes_on(tick); ++tick) {
    const bool is_gone = fuzz::push_for_a_tick(arm, wire.may_push) == IoStatus::Disconnected;
    THIMBLE_CHECK(!is_given_up || is_gone);
    is_given_up = is_gone;
  }
  wire.may_push = false;  // what is sent last lets go
  return 0;
}
