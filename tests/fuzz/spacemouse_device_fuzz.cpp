#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>

#include "drivers/spacemouse/find_model.hpp"
#include "drivers/spacemouse/pointer.hpp"
#include "drivers/spacemouse/spacemouse_device.hpp"
#include "tests/fuzz/device_under_fuzz.hpp"

namespace {

using namespace thimble;

// A puck that says what the input says, and is to be sent nothing.
class HostilePuck final : public bus::HidDevice {
 public:
  HostilePuck(fuzz::WireScript& script, fuzz::WireClock& clock) : script_(script), clock_(clock) {}
  IoStatus read_newest(bus::HidReport& out) noexcept override {
    if (is_gone_) return IoStatus::Disconnected;
    const fuzz::WireEvent event = script_.next(clock_, out.bytes, out.size);
    is_gone_ = event == fuzz::WireEvent::Trouble;
    if (is_gone_) return IoStatus::Disconnected;
    if (event != fuzz::WireEvent::Packet) return IoStatus::NoData;
    out.arrived_at = clock_.now();
    out.sequence = ++sequence_;
    return IoStatus::Ok;
  }
  IoStatus submit(std::span<const std::uint8_t> /*report*/) noexcept override {
    THIMBLE_CHECK(false);
    return IoStatus::Ok;
  }
  [[nodiscard]] bus::HidCounters counters() const noexcept override { return {}; }

 private:
  fuzz::WireScript& script_;
  fuzz::WireClock& clock_;
  std::uint64_t sequence_{0};
  bool is_gone_{false};
};

}  // namespace

// Whatever a puck says: the point is finite and stays within its reach, and nothing is sent. The
// first byte: which puck; the rest as WireScript says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fuzz::WireScript script({data + 1, size - 1});
  fuzz::WireClock clock;
  const auto& models = spacemouse::kSpaceMouseModels;
  spacemouse::SpaceMouseDevice puck(std::make_unique<HostilePuck>(script, clock),
                                    models[data[0] % std::size(models)], clock);
  bool may_push = false;
  for (int tick = 0; script.goes_on(tick); ++tick) {
    clock.sleep_until(clock.now() + std::chrono::microseconds(250));
    HapticState state;
    const IoStatus status = puck.read(state);
    if (status == IoStatus::Ok) {
      fuzz::require_sane(state);
      const Position3& tip = state.tip;
      const double away_m = std::hypot(tip.x, tip.y, tip.z);
      THIMBLE_CHECK(away_m <= spacemouse::Pointer::kRadius_m * (1 + 1e-9));
    }
    static_cast<void>(fuzz::push_for_a_tick(puck, may_push));
  }
  return 0;
}
