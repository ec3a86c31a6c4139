#pragma once

#include <chrono>

#include "daemon/coupling/arm_coupling.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// When constraints are too old to be trusted. Defaults: DESIGN section 4, row "constraint
// age"; a configuration may loosen or tighten them.
struct ConstraintAgeSettings {
  Duration freeze_floor{std::chrono::milliseconds(20)};
  Duration fade_floor{std::chrono::milliseconds(250)};
  Duration fade_time{std::chrono::milliseconds(100)};  // full to nothing, and back
};

// Watches the time since the last accepted reply: first the coordinate frame freezes, later
// the constraints fade to nothing; when replies return, force comes back as slowly.
//
// Thread: one servo thread. RT: all calls THIMBLE_RT. Errors: none.
class ConstraintAge {
 public:
  explicit ConstraintAge(const ConstraintAgeSettings& settings) noexcept : settings_(settings) {}

  THIMBLE_RT void restart(MonotonicTime now) noexcept;
  // Once a step, before the constraints are used. Age counts from restart() until the first
  // reply: an arm whose world never answers is flagged too.
  THIMBLE_RT void update(const ArmInput& input) noexcept;

  [[nodiscard]] bool is_frozen() const noexcept { return is_frozen_; }
  [[nodiscard]] bool is_fading() const noexcept { return is_fading_; }
  // Nothing is left of the old constraints: they must be dropped.
  [[nodiscard]] bool has_expired() const noexcept { return is_fading_ && gain_ <= 0; }
  // The reply of this very step ended a fade: what it says counts as new.
  [[nodiscard]] bool has_returned() const noexcept { return has_returned_; }
  // Share of the force to be shown, 0…1.
  [[nodiscard]] double gain() const noexcept { return gain_; }

 private:
  ConstraintAgeSettings settings_;
  MonotonicTime last_reply_{};
  double gain_{1};
  bool is_frozen_{false};
  bool is_fading_{false};
  bool has_returned_{false};
};

}  // namespace thimble::coupling
