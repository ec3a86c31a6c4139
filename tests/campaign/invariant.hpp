#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/servo/servo_loop.hpp"
#include "hal/plugin/sim_model.hpp"
#include "tests/campaign/tapped_arm.hpp"

namespace thimble::campaign {

// What an outsider knows after a tick: what the servo publishes, what reached the arm over its
// wire, what the arm then did, and what was done to all of them. Times on the arm's clock.
struct Observation {
  servo::ServoSnapshot servo{};
  const servo::ServoSnapshot* other{nullptr};  // of the arm nearby, where there is one
  plugin::ArmTruth truth{};
  WireSeen wire{};
  bool is_estop_healthy{true};
  bool is_deadman_held{true};
  bool is_wanted{true};  // somebody holds the lease
  bool is_network_up{true};
  std::uint32_t clear_asked{0};    // ClearRequest::id of the newest request
  bool is_clear_for_other{false};  // and it names another fault than the one latched then
  std::uint64_t spoilt_in{0};      // reports with wrong bytes so far, towards the servo
  std::uint64_t spoilt_out{0};     // towards the arm
  // When a report was last late on its way to the arm; older ones act before what is written now.
  MonotonicTime late_out_at{Duration::min() / 2};
  // Since when nothing disturbs them.
  MonotonicTime cable_ok_since{};
  MonotonicTime network_ok_since{};
  MonotonicTime world_ok_since{Duration::min() / 2};  // nobody edits it
  MonotonicTime tip_ok_since{Duration::min() / 2};    // nobody shoves it
  MonotonicTime edits_ok_since{};                     // none waits, or the network hears nothing
  MonotonicTime replies_ok_since{};                   // it has room for a hand
  MonotonicTime opening_ok_since{};                   // the arm is there and may be opened
};

// What the judges need to know of the configuration. Newton, metre, second.
struct Bounds {
  servo::ServoSettings servo{};
  servo::ServoSettings other_servo{};  // of the arm nearby
  double stiffness_newton_per_m{800};
  double damping_newton_s_per_m{5};
  double friction{0};
  double hysteresis_m{0.0005};
  double workspace_radius_m{0.08};
  double coordinate_spring_newton_per_m{50};
  Duration round_trip{};           // injected, at its longest
  bool is_network_lossless{true};  // every sample is answered
  bool is_energy_bounded{true};    // the scheme promises it
  bool is_world_honest{true};      // what answers the arm is a world
  bool is_tapped{true};            // Observation::wire is there, of an arm with a watchdog
  // From power to the first sample, and from a cable that is well again to the next one.
  Duration boot{std::chrono::seconds(1)};  // the LEDs of the PHANToM board's firmware
  Duration silence{};
};

struct Breach {
  std::string rule;
  double value{0};
  double bound{0};
  std::uint64_t tick{0};
  MonotonicTime at{};
};
// "rise of the force sent: 1200 instead of at most 1000, at 3.204 s, tick 3204".
[[nodiscard]] std::string to_text(const Breach& breach);

// Where breaches are told; the first counts.
class Findings {
 public:
  void look_at(const servo::ServoFrame& frame) noexcept { tick_ = frame.tick, now_ = frame.now; }
  // value <= bound; not so for NaN.
  void at_most(const char* rule, double value, double bound) {
    if (value <= bound || breach_) return;
    breach_ = Breach{rule, value, bound, tick_, now_};
  }
  void require(const char* rule, bool is_kept) {
    if (!is_kept) at_most(rule, 1, 0);
  }
  [[nodiscard]] const std::optional<Breach>& breach() const noexcept { return breach_; }

 private:
  std::uint64_t tick_{0};
  MonotonicTime now_{};
  std::optional<Breach> breach_;
};

// What a judge that may look away did judge.
struct Judged {
  std::uint64_t touches{0};
  std::uint64_t excused_touches{0};
  std::uint64_t ticks_due_on_usb{0};  // in which a bare USB arm had to be heard
};

// One thing that must hold in every tick of any session; docs/campaign.md has them all, with
// the source of each bound. Deterministic, and cheap: it looks at each of a billion ticks.
class Invariant {
 public:
  virtual ~Invariant() = default;
  virtual void see(const Observation& now, Findings& findings) = 0;
  // Adds its own to `judged`, at the end.
  virtual void tell(Judged& /*judged*/) const {}
};

[[nodiscard]] std::unique_ptr<Invariant> make_sent_force(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_arm_force(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_zero_after_stop(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_let_go(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_arm_truth(const Bounds& bounds);
// In place of the three that need the tap.
[[nodiscard]] std::unique_ptr<Invariant> make_untapped_arm(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_latch(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_recovery(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_energy(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_progress(const Bounds& bounds);
[[nodiscard]] std::unique_ptr<Invariant> make_bystander(const Bounds& bounds);
[[nodiscard]] std::vector<std::unique_ptr<Invariant>> make_invariants(const Bounds& bounds);

}  // namespace thimble::campaign
