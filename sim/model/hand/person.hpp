#pragma once

#include <atomic>
#include <cstdint>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/hand/hand.hpp"

namespace thimble::sim {

// A person at a simulated arm who knows what the calibration asks for: brings the arm to its
// home pose, presses the button, waits, then lets the hand play its motion.
//
// Times since the first plant step, or since begin_calibration():
//   0.00 s  takes hold of the tip and moves it home; where the arm has another place to start from,
//           to that first, and home from 0.20 s on
//   0.40 s  is there and lets it settle
//   0.55 s  presses the calibration button
//   0.70 s  releases it
//   1.20 s  starts the motion; start_motion() makes that sooner, but not before the release
//
// Thread: that of the arm's model; ask_to_calibrate() from any; construction and destruction
// while nobody runs it.
// RT: everything but construction. Ownership: holds the arm's tip for as long as it lives; the
// arm must outlive it.
class Person final : public plugin::TipLoad {
 public:
  static constexpr Duration kStartAt{200'000'000};
  static constexpr Duration kHomeAt{400'000'000};
  static constexpr Duration kPressAt{550'000'000};
  static constexpr Duration kReleaseAt{700'000'000};
  static constexpr Duration kMotionAt{1'200'000'000};

  Person(plugin::ArmBackend& arm, const HandSettings& settings);
  ~Person() override;
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  // Once more from the beginning: after the arm lost its power.
  THIMBLE_RT void begin_calibration() noexcept;
  // As a person does who reads "hold the arm and press the button" in the status: it begins
  // once more, unless it is at it already.
  THIMBLE_RT void ask_to_calibrate() noexcept { is_asked_.store(true, std::memory_order_relaxed); }
  THIMBLE_RT void start_motion() noexcept { is_told_to_move_ = true; }

  THIMBLE_RT Force3 force_on_tip(MonotonicTime t, Duration dt, Position3 tip,
                                 Velocity3 velocity) noexcept override;
  [[nodiscard]] bool is_button_pressed(MonotonicTime t) const noexcept override {
    return hand_.is_button_pressed(t);
  }

  enum class Phase : std::uint8_t { GoingToStart, GoingHome, Pressing, Waiting, Moving };
  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] const Hand& hand() const noexcept { return hand_; }

 private:
  plugin::ArmBackend& arm_;
  Hand hand_;
  Phase phase_{Phase::GoingHome};
  Duration elapsed_{};
  bool is_told_to_move_{false};
  std::atomic<bool> is_asked_{false};
};

}  // namespace thimble::sim
