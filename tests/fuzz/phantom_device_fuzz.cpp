#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "drivers/phantom/find_model.hpp"
#include "drivers/phantom/hid_link.hpp"
#include "drivers/phantom/phantom_device.hpp"
#include "drivers/phantom/text_link.hpp"
#include "tests/fuzz/device_under_fuzz.hpp"

namespace {

using namespace thimble;

constexpr double kAmplifier_a = 6;

// What the controller is told for its motors, judged.
struct Motors {
  bool may_push{false};  // the newest state was one of a calibrated arm
  std::array<double, 3> peak_a{};

  void take(const std::array<long, 3>& milliampere) const {
    for (std::size_t i = 0; i < 3; ++i) {
      THIMBLE_CHECK(milliampere[i] == 0 || may_push);
      THIMBLE_CHECK(std::abs(milliampere[i]) <= std::lround(peak_a[i] * 1000));
    }
  }
};

// A controller that says what the input says.
class HostileWire {
 public:
  HostileWire(fuzz::WireScript& script, fuzz::WireClock& clock, Motors& motors)
      : motors_(motors), script_(script), clock_(clock) {}
  template <class Packet>
  IoStatus read(Packet& out) noexcept {
    if (is_gone_) return IoStatus::Disconnected;
    const fuzz::WireEvent event = script_.next(clock_, out.bytes, out.size);
    if (event == fuzz::WireEvent::Trouble) {
      is_gone_ = script_.trouble == fuzz::WireTrouble::Disconnected;
      if (script_.trouble == fuzz::WireTrouble::Broken) ++sequence_;  // one of them was lost
      return is_gone_ ? IoStatus::Disconnected : IoStatus::ProtocolError;
    }
    if (event != fuzz::WireEvent::Packet) return IoStatus::NoData;
    out.arrived_at = clock_.now();
    out.sequence = ++sequence_;
    return IoStatus::Ok;
  }
  [[nodiscard]] IoStatus sent() const noexcept {
    return is_gone_ ? IoStatus::Disconnected : IoStatus::Ok;
  }

 protected:
  Motors& motors_;

 private:
  fuzz::WireScript& script_;
  fuzz::WireClock& clock_;
  std::uint64_t sequence_{0};
  bool is_gone_{false};
};

class HostileHid final : public bus::HidDevice, private HostileWire {
 public:
  using HostileWire::HostileWire;
  IoStatus read_newest(bus::HidReport& out) noexcept override { return read(out); }
  IoStatus submit(std::span<const std::uint8_t> report) noexcept override {
    THIMBLE_CHECK(report.size() >= 14);
    const auto field = [&](std::size_t i) {
      std::int16_t value = 0;
      std::memcpy(&value, report.data() + 2 * i, sizeof value);  // this machine is little-endian
      return long{value};
    };
    THIMBLE_CHECK(field(3) == 0 || field(3) == 1);
    motors_.take({field(0), field(1), field(2)});
    return sent();
  }
  [[nodiscard]] bus::HidCounters counters() const noexcept override { return {}; }
};

class HostileSerial final : public bus::SerialPort, private HostileWire {
 public:
  using HostileWire::HostileWire;
  IoStatus read(bus::SerialChunk& out) noexcept override {
    // A port that is read until it is empty must not be followed through all of the input.
    if (std::exchange(has_spoken_, !has_spoken_)) return IoStatus::NoData;
    return HostileWire::read(out);
  }
  IoStatus submit(std::span<const std::uint8_t> message) noexcept override {
    const std::string text(message.begin(), message.end());
    std::array<long, 3> current{};
    int end = 0;
    const int read =
        std::sscanf(text.c_str(), " [%ld,%ld,%ld]%n", &current[0], &current[1], &current[2], &end);
    THIMBLE_CHECK(read == 3 && end > 0);
    motors_.take(current);
    return sent();
  }
  [[nodiscard]] bus::SerialCounters counters() const noexcept override { return {}; }

 private:
  bool has_spoken_{false};
};

}  // namespace

// Whatever a controller says: the arm's state is finite, no current goes beyond the arm's peak, and
// none at all unless it was calibrated. The first byte: HID (which form) or text, and which arm, be
// it one that never comes with that controller; the rest as WireScript says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool is_text = (data[0] & 1U) != 0;
  const bool is_teensy = (data[0] & 2U) != 0;
  fuzz::WireScript script({data + 1, size - 1});
  fuzz::WireClock clock;
  Motors motors;
  const phantom::PhantomModel& model =
      phantom::kPhantomModels[(data[0] >> 2U) % std::size(phantom::kPhantomModels)];
  std::unique_ptr<phantom::ControllerLink> link;
  if (is_text) {
    link = std::make_unique<phantom::TextLink>(
        std::make_unique<HostileSerial>(script, clock, motors), model, kAmplifier_a, clock);
  } else {
    link = std::make_unique<phantom::HidLink>(
        std::make_unique<HostileHid>(script, clock, motors),
        is_teensy ? phantom::ReportForm::Teensy : phantom::ReportForm::Mbed);
  }
  phantom::PhantomDevice arm(std::move(link), model, kAmplifier_a);
  for (std::size_t i = 0; i < 3; ++i) motors.peak_a[i] = arm.capabilities().peak_current_a[i];
  for (int tick = 0; script.goes_on(tick); ++tick) {
    clock.sleep_until(clock.now() + std::chrono::microseconds(250));
    static_cast<void>(fuzz::push_for_a_tick(arm, motors.may_push));
  }
  motors.may_push = false;  // what is sent last lets go
  return 0;
}
