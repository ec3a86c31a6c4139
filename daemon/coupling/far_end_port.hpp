#pragma once

#include <cstdint>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/constraint_age.hpp"
#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// Whether every number of it is finite and none above 1e9 in its SI unit (kAbsurd).
[[nodiscard]] THIMBLE_RT bool is_sound(const FarEnd& far) noexcept;

// What the arm halves have in common that leave the hand where it is, with no offset: which replies
// count, how old they are, the share of the force that is shown, and the sample.
//
// A silent world: what was heard last holds for the fade floor of the constraint age, then the
// force falls to 0 within its fade time, and the far end is forgotten: `restart` of the samples
// changes, so that the slave, or the ghost, starts again at the hand. A new session (the world
// restarted), or a reply after an outage, begins an epoch: what was known is void, and the force
// rises from 0 within the fade time. A carriage must not deliver what answers a sample of an
// earlier `restart`.
//
// Thread: one servo thread. RT: THIMBLE_RT. Errors: replies that are not sound are as good as none.
class FarEndPort {
 public:
  explicit FarEndPort(const ConstraintAgeSettings& age) noexcept
      : age_(age), fade_(age.fade_time) {}

  THIMBLE_RT void reset(MonotonicTime now, Position3 tip) noexcept;
  // First of a step, whose tip must be finite: the reply that came with it if it is usable, or
  // nullptr.
  THIMBLE_RT const ConstraintSet* hear(const ArmInput& input, bool is_usable) noexcept;
  // The same, of what the far end computed.
  THIMBLE_RT const FarEnd* listen(const ArmInput& input) noexcept;
  // Of this step: forget the far end before its reply is used.
  [[nodiscard]] bool is_new_epoch() const noexcept { return is_new_epoch_; }
  // Last of a step: `wish` is shown as far as the far end can be trusted.
  THIMBLE_RT ArmOutput show(const ArmInput& input, Force3 wish, bool is_pressing,
                            const ToolProperties& tool) noexcept;
  // Instead of all that, of a tip that is not finite: a force that is not finite either, which
  // latches a fault behind the coupling. The state stays as it was.
  THIMBLE_RT ArmOutput refuse(const ArmInput& input) noexcept;

  // Number of this step's sample.
  [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
  // Share of the wish that is shown, 0…1.
  [[nodiscard]] double gain() const noexcept { return age_.gain() * onset_gain_; }
  // Since construction.
  [[nodiscard]] std::uint64_t rejected_replies() const noexcept { return rejected_replies_; }

 private:
  [[nodiscard]] HandSample sample(const ArmInput& input) const noexcept;
  void begin_epoch() noexcept;

  ConstraintAge age_;
  Duration fade_;
  Position3 last_tip_{};
  double onset_gain_{0};
  std::uint64_t sequence_{0};
  std::uint64_t applied_reply_{0};
  std::uint64_t rejected_replies_{0};
  std::uint32_t session_{0};
  std::uint32_t restarts_{0};
  bool has_session_{false};
  bool has_expired_{false};
  bool is_new_epoch_{false};
  bool was_pressing_{false};
};

}  // namespace thimble::coupling
