#pragma once

#include "hal/plugin/arm_backend.hpp"
#include "sim/model/hand/hand.hpp"

namespace thimble::sim {

// The hand that the verbs move: it takes hold of a simulated arm's tip, brings it firmly to a point
// and keeps it there, and gives way to a wall as a person does.
//
// Thread: that of the arm's model. RT: all but construction. Units: SI, the arm's base frame.
// Ownership: holds the tip while it has hold of it; the arm must outlive it. Errors: none.
class ExportHand final : public plugin::TipLoad {
 public:
  explicit ExportHand(plugin::ArmBackend& arm) : arm_(&arm) {}
  ~ExportHand() override { arm_->hold_tip(nullptr); }
  ExportHand(const ExportHand&) = delete;
  ExportHand& operator=(const ExportHand&) = delete;

  // `within`: half of it to where an arm that needs that has to be brought first.
  void go_home(Duration within) noexcept;
  void move_to(Position3 point, Duration within) noexcept;
  void let_go() noexcept;
  [[nodiscard]] bool has_hold() const noexcept { return has_hold_; }

  Force3 force_on_tip(MonotonicTime t, Duration dt, Position3 tip,
                      Velocity3 velocity) noexcept override;
  [[nodiscard]] bool is_button_pressed(MonotonicTime) const noexcept override { return false; }

 private:
  void take_hold() noexcept;

  plugin::ArmBackend* arm_;
  Hand hand_{HandSettings{.motion = HandMotion::Still}};
  bool has_hold_{false};
  Duration left_of_first_leg_{};  // 0: there is no second one
  Duration second_leg_{};
};

}  // namespace thimble::sim
