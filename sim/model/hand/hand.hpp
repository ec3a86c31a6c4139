#pragma once

#include <cstdint>

#include "hal/plugin/sim_model.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/hand/hand_path.hpp"
#include "sim/model/hand/hand_settings.hpp"

namespace thimble::sim {

// A hand: a mass that a spring and a damper (the muscles) pull towards where the person wants
// it, held to the arm's tip by a stiffer pair. It feels the arm's force and gives way.
//
// It takes hold where the tip is when first asked, and stays there until it is sent elsewhere.
//
// Thread: that of the arm's model. RT: all but the constructor. Units: SI, arm's base frame.
// Ownership: none. Errors: none; settings that check() refuses end the process.
class Hand final : public plugin::TipLoad {
 public:
  explicit Hand(const HandSettings& settings);

  // `dt` at most 100 us: the contact's stiffness bounds it.
  THIMBLE_RT Force3 force_on_tip(MonotonicTime t, Duration dt, Position3 tip,
                                 Velocity3 velocity) noexcept override;
  [[nodiscard]] bool is_button_pressed(MonotonicTime) const noexcept override { return false; }

  // Brings the finger to a point, smoothly, within `duration`, and holds it there firmly.
  THIMBLE_RT void hold_at(Position3 point, Duration duration) noexcept;
  // Goes to the origin with a relaxed grip, then plays the motion from its start.
  THIMBLE_RT void start_motion() noexcept;

  [[nodiscard]] bool is_in_motion() const noexcept { return mode_ == Mode::Motion; }
  [[nodiscard]] const PathPoint& reference() const noexcept { return reference_; }
  [[nodiscard]] const PathPoint& finger() const noexcept { return finger_; }
  // The last force on the tip; the person feels its opposite.
  [[nodiscard]] Force3 force() const noexcept { return force_; }

 private:
  enum class Mode : std::uint8_t { Rest, Hold, ToOrigin, Motion };

  void take_hold(Position3 tip, Velocity3 velocity) noexcept;
  void begin_stroke() noexcept;
  [[nodiscard]] PathPoint advance_reference(Duration dt) noexcept;

  HandSettings settings_;
  HandPath path_;
  Mode mode_{Mode::Rest};
  bool has_hold_{false};
  Position3 target_{};        // of Hold
  Duration target_within_{};  // of Hold
  Stroke stroke_{};           // of Hold and ToOrigin
  double stroke_scale_{1};    // how much faster than planned the stroke is played
  Duration stroke_elapsed_{};
  PathPoint reference_{};
  PathPoint finger_{};
  Force3 force_{};
};

}  // namespace thimble::sim
