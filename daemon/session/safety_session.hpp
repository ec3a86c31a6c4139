#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/config/config.hpp"
#include "daemon/safety/safety_chain.hpp"
#include "daemon/session/runtime.hpp"
#include "hal/bus/gpio_lines.hpp"
#include "hal/rt/inheriting_mutex.hpp"
#include "hal/rt/wake_signal.hpp"
#include "hal/rt/word_seqlock.hpp"

namespace thimble::session {

// What is so after each start, and no stop.
inline constexpr std::string_view kNotYetCleared =
    "the safety lines are not yet cleared since the start; look at the arms, then clear each that "
    "shall go on";
// Whoever holds on and feels nothing.
inline constexpr std::string_view kReleaseDeadman =
    "the deadman was not let go of since the newest stop, or the start; let go of it, then hold it";

// The safety lines of a configuration, watched for all arms of a runtime: it opens them, and again
// when they were lost, runs the chain and hands its verdict to the servos, who read it in each
// tick.
//
// Where there is an enable line, an arm without a watchdog that may hold a force and is out of
// reach, lost, or told zero in vain for kDeaf, is a stop, too: the hardware that ENABLE holds
// closed is all that can end that force (decision 0494).
//
// Thread: step() and close() from one, not a servo's; ask_reset(), answer(), status() and
// trouble() from any; supervise(), leave_out() and exchange_arms() from one other, which alone
// changes the runtime. exchange_arms() waits for the chain's step at most, never for a chip.
// Ownership: runtime, chips and wake must outlive it.
class SafetySession {
 public:
  // No arm may be driven from here on. `wake`, of the thread that steps, may be nullptr.
  SafetySession(const config::SafetyConfig& safety, Runtime& runtime, bus::GpioChips& chips,
                rt::WakeSignal* wake);
  ~SafetySession();
  SafetySession(const SafetySession&) = delete;
  SafetySession& operator=(const SafetySession&) = delete;

  // At least every kStep, and when `wake` was signalled. The clock is read anew behind whatever was
  // waited for: a beat is not put by a time that is over.
  void step(const Clock& clock);
  // The lines go, their outputs low. No step() follows.
  void close() { lines_.reset(); }

  // Does `change`, which puts other arms into the runtime, while nobody here looks at them. Those
  // that are there then have heard the verdict before anybody drives them.
  void exchange_arms(const std::function<void()>& change);
  // The servo of that arm, by its place in the runtime, is to end before such an exchange: until
  // then ENABLE beats without it. Of an arm that is driven by nobody: a stand-in, or one that is
  // waited for.
  void leave_out(std::size_t arm);

  // A person asks to go on after a stop: the number that answer() has when a step has judged it.
  // Not granted by a step that found the lines new, or that comes later than kUnwatched: whoever
  // asked may have been refused meanwhile, or gone.
  std::uint32_t ask_reset();
  struct Answer {
    std::uint32_t id{0};
    bool is_free{false};  // nothing is stopped any more
  };
  [[nodiscard]] Answer answer() const noexcept;

  [[nodiscard]] safety::ChainStatus status() const noexcept;
  // Why the lines are not there, with the system's words; empty when they are.
  [[nodiscard]] std::string trouble() const;
  // In words for a person: what is wrong now, or that somebody has to clear, or to let go of the
  // deadman; empty when all is well.
  [[nodiscard]] std::string explanation() const;
  // Whether nothing was stopped since the start, but for the start itself.
  [[nodiscard]] bool is_as_started() const noexcept {
    return status().cause == safety::ChainTrouble::None;
  }
  [[nodiscard]] const config::SafetyConfig& config() const noexcept { return config_; }

  // Stops all arms when step() was not called for kUnwatched: nobody would hear the button.
  void supervise(MonotonicTime now) noexcept;

  static constexpr Duration kStep =
      std::chrono::milliseconds(5);  // ours: a beat's time is kept to it
  // How long ENABLE rests at least once an arm is out of reach. Ours: the relay has fallen after
  // 0.1 s (docs/safety-wiring.md), and a supply's capacitors take their time.
  static constexpr Duration kCut = std::chrono::seconds(1);
  // How long an arm may hold a force, as far as is known, that it is told to let go of. Ours: zeros
  // that arrive are known of after 20 ms, and a Falcon that lost an answer is asked again after 4.
  static constexpr Duration kDeaf = std::chrono::milliseconds(100);
  static constexpr Duration kReopen = std::chrono::milliseconds(500);     // between tries
  static constexpr Duration kUnwatched = std::chrono::milliseconds(400);  // ours: twice kSilence

 private:
  [[nodiscard]] std::string explain_stop(const safety::ChainStatus& now) const;

  struct Arm {
    ArmRig* rig{nullptr};
    std::uint64_t ticks_seen{0};
    bool ends_force_itself{true};  // it has a watchdog, or no motors
    // Since when it may hold a force that it should not have.
    std::optional<MonotonicTime> holds_since{};
    bool has_stopped{false};  // the chain, for that
    bool is_left_out{false};  // its servo ends, to be exchanged
  };

  [[nodiscard]] std::unique_ptr<bus::GpioLines> take_lost_lines(MonotonicTime now);
  [[nodiscard]] bool open_lines(MonotonicTime now);
  void note_trouble(std::string text);
  void note_out_of_reach(const std::string& arm);
  [[nodiscard]] bool have_servos_beaten();
  void know_arms();
  void stop_for_arms_out_of_reach(MonotonicTime now);
  [[nodiscard]] static bool is_out_of_reach(Arm& arm, const servo::ServoSnapshot& seen,
                                            MonotonicTime now) noexcept;
  void publish();
  // A request that may not be granted is spent all the same.
  void answer_reset(bool may_be_free);
  [[nodiscard]] bool is_late(MonotonicTime now) const noexcept;

  // The thread of the lines has a real-time priority, who shares these locks has none.
  rt::InheritingMutex arms_lock_;  // of the runtime's arms, and of the chain that they hear
  config::SafetyConfig config_;
  Runtime& runtime_;
  bus::GpioChips& chips_;
  rt::WakeSignal* wake_;
  safety::SafetyChain chain_;
  std::unique_ptr<bus::GpioLines> lines_;
  MonotonicTime next_try_{};
  std::vector<Arm> arms_;
  rt::WordSeqlock<safety::ChainStatus> published_;
  std::atomic<std::uint32_t> reset_asked_{0};
  std::atomic<std::uint64_t> reset_answer_{0};  // the id, twice, and whether it is free
  std::atomic<std::int64_t> stepped_at_ns_{0};  // 0: never
  std::atomic<bool> is_unwatched_{false};
  mutable rt::InheritingMutex trouble_lock_;
  std::string trouble_;
  std::string out_of_reach_;  // the arm that was, of the newest such stop
};

}  // namespace thimble::session
