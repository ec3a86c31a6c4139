#pragma once

#include <cstdint>

#include "daemon/coupling/energy_observer.hpp"
#include "daemon/coupling/messages.hpp"
#include "hal/rt/annotations.hpp"

namespace thimble::coupling {

// What the link knows of itself; read by the arm half to judge the age of constraints.
struct LinkQuality {
  bool is_up{false};      // a reply was accepted and the peer is not silent
  Duration round_trip{};  // smoothed; 0 until known
  Duration jitter{};      // mean deviation of the round trip
};

struct ArmInput {
  MonotonicTime now{};
  Duration dt{};             // since the previous step, > 0
  Position3 tip{};           // p, base frame of the arm
  Velocity3 tip_velocity{};  // filtered
  std::uint32_t buttons{0};
  const ConstraintSet* fresh{nullptr};  // a reply that arrived since the previous step, or none
  LinkQuality link{};
};

struct ArmOutput {
  Force3 force{};          // wish, before the limiter; base frame (= world frame, axes parallel)
  Displacement3 offset{};  // o
  HandSample sample{};     // to be sent now
  std::uint32_t new_contacts{0};  // planes that began to press in this step
  bool is_in_contact{false};
  bool is_foretold{false};  // walls are known before the hand is there: it is felt where it is now
  bool is_frozen{false};    // constraint age: coordinate frame frozen
  bool is_fading{false};    // constraint age: constraints fade to zero
};

// The arm half of a coupling scheme: turns the state of the arm and what the world side said
// into a force, at the servo's rate. The port of the hand is here, once for all schemes: no arm
// half goes without an observer of what it gives.
//
// Thread: one servo thread; energy() too. RT: both calls THIMBLE_RT, no allocation.
// Errors: none; a non-finite force is caught behind it and latches a fault.
class ArmCoupling {
 public:
  virtual ~ArmCoupling() = default;
  // Forgets constraints, offset and contacts; the ghost restarts at the hand.
  THIMBLE_RT void reset(MonotonicTime now, Position3 tip) noexcept {
    energy_.reset(tip);
    restart(now, tip);
  }
  THIMBLE_RT ArmOutput step(const ArmInput& input) noexcept {
    ArmOutput output = advance(input);
    energy_.observe(input.tip, output.force);
    return output;
  }
  // Work of what was wished on the hand, since reset(): before the limiter.
  [[nodiscard]] const PortObserver& energy() const noexcept { return energy_; }
  // Tunes the wave impedance b while it runs, from one control thread. False: it has none.
  virtual bool set_impedance(Damping /*b*/) noexcept { return false; }

 private:
  THIMBLE_RT virtual void restart(MonotonicTime now, Position3 tip) noexcept = 0;
  THIMBLE_RT virtual ArmOutput advance(const ArmInput& input) noexcept = 0;

  PortObserver energy_{};
};

}  // namespace thimble::coupling
