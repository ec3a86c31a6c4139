#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "daemon/safety/chain_status.hpp"
#include "daemon/safety/deadman.hpp"
#include "daemon/safety/estop_channels.hpp"
#include "daemon/safety/estop_latch.hpp"
#include "daemon/safety/line_reader.hpp"
#include "hal/base/time.hpp"
#include "hal/bus/gpio_lines.hpp"

namespace thimble::safety {

// Half a period of the enable line, 25 Hz: a charge pump that holds 100 ms lives through a beat
// that comes late, and a hub's adapter is not kept busy by it. Ours; docs/safety-wiring.md.
inline constexpr Duration kEnableHalfPeriod = std::chrono::milliseconds(20);
// For how long no rise of the enable line may be taken while the latch is free. A rise charges the
// relay of docs/safety-wiring.md, which may fall 78 ms after the last; power that was cut must not
// come back by itself under arms that are driven. A rise comes every 40 ms, so one beat may be
// missed (60), two may not (80); below 75, as it is looked at every 5 ms. Ours.
inline constexpr Duration kEnableGap = std::chrono::milliseconds(70);
// Of the lamp while a person is awaited.
inline constexpr Duration kLampHalfPeriod = std::chrono::milliseconds(500);

// Which line of the claim is what: inputs are the channels of the emergency stop, then the deadman;
// outputs the enable line, then the lamp, as far as there are any.
struct ChainSettings {
  std::size_t estop_channels{1};  // 1 or 2
  bool is_closed_high{false};     // of an input whose contact is closed: released, or held
  bool has_deadman{false};
  bool has_enable{false};
  bool has_lamp{false};
  [[nodiscard]] std::size_t inputs() const noexcept {
    return estop_channels + (has_deadman ? 1 : 0);
  }
};

// Emergency stop, deadman, enable and lamp: what the lines say, judged, latched and answered.
//
// Enable is beaten, never held: one level, be it low or high, tells the hardware to cut the power.
// It is beaten while the latch is free, only as fast as the servos beat, and not before the chip
// has taken the beat before; a pause of kEnableGap, be it the servos', the chip's or of who calls
// step(), is a stop. The lamp is lit while the latch
// is free, blinks while all is healthy and a person is awaited, and is dark otherwise.
//
// Thread: one, never a servo's. It makes no system call but those of the lines. Not RT.
// Ownership: keeps no lines; those of a step need to live no longer than it.
// Errors: none; what is wrong with the lines is a stop, and in status().
class SafetyChain {
 public:
  explicit SafetyChain(const ChainSettings& settings) noexcept;

  // Often: at least every 5 ms, and when the lines woke their user. `lines`: nullptr while there
  // are none. `have_servos_beaten` is asked at most once per half period of the enable line.
  template <class Beaten>
  void step(bus::GpioLines* lines, MonotonicTime now, const Beaten& have_servos_beaten) noexcept {
    judge(lines, now);
    if (lines == nullptr || latch_.is_stopped()) return rest(lines, now);
    if (is_beat_due(now)) beat(lines, now, have_servos_beaten());
  }
  // Another chip than in the step before.
  void restart_lines() noexcept;
  // A person asks to go on; true when nothing is stopped now.
  bool reset() noexcept;
  // From without: a stop, as if a line had asked for it.
  void stop(ChainTrouble cause) noexcept;
  // The same, which nobody can reset before `until`.
  void hold(ChainTrouble cause, MonotonicTime until) noexcept;

  [[nodiscard]] const ChainStatus& status() const noexcept { return status_; }

 private:
  void judge(bus::GpioLines* lines, MonotonicTime now) noexcept;
  [[nodiscard]] ChainTrouble find_trouble(bus::GpioLines* lines, MonotonicTime now) noexcept;
  void judge_channels() noexcept;
  void judge_deadman() noexcept;
  // Whether the chip has taken the newest beat.
  void look_at_enable(bus::GpioLines& lines, MonotonicTime now) noexcept;
  [[nodiscard]] bool has_enable_paused(MonotonicTime now) noexcept;
  [[nodiscard]] bool is_beat_due(MonotonicTime now) const noexcept;
  void beat(bus::GpioLines* lines, MonotonicTime now, bool have_servos_beaten) noexcept;
  void rest(bus::GpioLines* lines, MonotonicTime now) noexcept;
  // Whether the chip has taken all that was put before, or some of it since the last call.
  bool put(bus::GpioLines& lines, std::size_t output, bool is_high, MonotonicTime now) noexcept;

  ChainSettings settings_;
  LineReader reader_;
  EstopChannels channels_;
  EstopLatch latch_;
  ChainStatus status_;
  Deadman deadman_;
  bool is_enable_high_{false};
  MonotonicTime next_beat_{};
  MonotonicTime last_beat_{};
  bool is_beat_taken_{true};                  // the newest
  MonotonicTime untaken_at_{};                // when it was put, or last seen not to be taken
  std::optional<MonotonicTime> charged_at_;   // of the newest rise, at the earliest; none: stopped
  std::optional<MonotonicTime> stuck_since_;  // the chip takes no output
  ChainTrouble held_for_{ChainTrouble::None};
  MonotonicTime held_until_{};
};

}  // namespace thimble::safety
