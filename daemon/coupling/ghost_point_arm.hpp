#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/constraint_age.hpp"
#include "daemon/coupling/coordinate_frame.hpp"
#include "daemon/coupling/messages.hpp"
#include "daemon/coupling/wall_spring.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::coupling {

// Tuning of the ghost point scheme. Sources: thesis appendix A in SI units, as read in
// docs/decisions/0050-ghost-point-defaults.md; what differs says so.
struct GhostPointSettings {
  Stiffness stiffness{800};
  Damping damping{5};  // half of the thesis's 10: decision 0050
  double friction{0};  // Coulomb's coefficient; the thesis has none
  // Ceilings of what a world may ask for; the hardest arm we know of (a Falcon) takes these.
  Stiffness max_stiffness{3000};
  Damping max_damping{20};
  double max_friction{1};  // ours: rubber on wood
  Stiffness coordinate_spring{50};
  double coordinate_spring_share{0.5};  // of the wall's force, at most: decision 0055
  Duration coordinate_spring_ramp{std::chrono::milliseconds(100)};  // thesis: a step
  double hysteresis_m{0.0005};       // upper bound; see effective_hysteresis_m() of told_planes.hpp
  double cell_m{0};                  // edge of the world's cells; 0: it has none
  double relaxation_m_per_s{0.025};  // thesis: 0.25 mm each tenth tick of 1 kHz
  double max_offset_m{0.25};         // length of the offset: decision 0056
  Duration redetection_guard{std::chrono::milliseconds(50)};  // decision 0051
  ConstraintAgeSettings age{};
};

// For the status and for tests; since construction.
struct GhostPointCounters {
  std::uint64_t offset_events{0};    // the frame was shifted by a constraint
  std::uint64_t redetections{0};     // a face pressed again within the guard: chatter
  std::uint64_t rejected_planes{0};  // not is_sound() (wall_penalty.hpp)
  bool operator==(const GhostPointCounters&) const = default;
};

// The arm half of the time/space trade-off (thesis 3.7): a wall learned of late shifts the
// coordinate frame so that the finger rests just inside it, and is then rendered locally.
//
//   q = p + o                                        what is sent
//   o ← o + n·(H − x)                                a reply names a new plane with x > H
//   F = −g·Σ n·max(0, K·x + B·(n·v) + min(k_o·s, K·x/2))    over the planes with x > 0
//
// p, v  tip, m, m/s, arm's frame        n, d  of a plane: 1, m; n points into the obstacle
// o     coordinate offset, m            x     = n·q − d, penetration, m
// F     on the hand, N                  K, B  of the plane, else of the arm: N/m, N·s/m
// H     hysteresis, m                   k_o   coordinate spring, N/m
// g     share that is shown, 0…1        s     part of −n·o that it shows, m, at least 0
//
// SOURCE: thesis 3.7 and appendix A; teleop.md 2(e). In free space o returns straight at
// relaxation_m_per_s. First contact of a hand at v: |o| = v·(D + δ) − H, δ at most a period of the
// servo; in lock-step D counts once to twice. Energy: at most ½·K·H² a shift and ½·k_o·o² a touch.
// README.md tells what differs from the printed client, and why.
//
// Thread: one servo thread; counters() too. RT: reset(), step() THIMBLE_RT.
// Frames: p in the arm's base frame; planes and q = p + o in the world's, axes parallel.
// Errors: unsound planes are ignored and counted. A tip that is not finite gives a force that
//         is not finite (the limiter latches the fault) and leaves the state as it was.
class GhostPointArm final : public ArmCoupling {
 public:
  explicit GhostPointArm(const GhostPointSettings& settings) noexcept;

  // As step(), with planes that are known here: `said`, or none, instead of those of input.fresh,
  // which still tells that the world is alive.
  THIMBLE_RT ArmOutput step_as_told(const ArmInput& input, const ConstraintSet* said) noexcept;
  [[nodiscard]] Displacement3 offset() const noexcept { return frame_.offset(); }

  [[nodiscard]] const GhostPointCounters& counters() const noexcept { return counters_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  // A face that the world told of. Held: in the newest set, and rendered. Else only
  // remembered: as a barrier that relaxation must not cross, and to know it again.
  struct Contact {
    ConstraintPlane plane{};
    WallSpring spring{};
    bool is_held{false};
    bool is_barrier{false};
    bool is_pressing{false};
    bool has_pressed{false};
    MonotonicTime last_pressed{};
    // Coordinate spring: the displacement shown slides from ramp_from to the true one.
    double ramp_from_m{0};
    double ramp_elapsed_s{0};
    double shown_m{0};
    // Friction: where on the surface the tip sticks, arm's frame, so that no shift of the world's
    // frame is felt along a wall.
    Position3 stuck_at{};
  };
  static constexpr std::size_t kMaxContacts = 2 * kMaxPlanes;
  using ContactList = rt::StaticVector<Contact, kMaxContacts>;

  [[nodiscard]] ArmOutput refuse(const ArmInput& input) const noexcept;
  [[nodiscard]] bool names_what_is_held(const PlaneList& planes) const noexcept;
  void apply(const ConstraintSet& set, const ArmInput& input) noexcept;
  [[nodiscard]] Contact adopt(const ConstraintPlane& plane, const Contact* known, Position3 tip,
                              double depth_felt_m, bool is_void) noexcept;
  void remember(const std::array<bool, kMaxContacts>& is_taken, const ArmInput& input,
                ContactList& next) const noexcept;
  void relax(const ArmInput& input) noexcept;
  void press(const ArmInput& input, ArmOutput& output) noexcept;
  void begin(Contact& contact, const ArmInput& input, ArmOutput& output) noexcept;
  [[nodiscard]] Force3 rub_along(Contact& contact, const ArmInput& input,
                                 const SurfaceProperties& surface,
                                 double wall_newton) const noexcept;
  // Within the redetection guard: it is the same touch (decision 0051).
  [[nodiscard]] bool was_pressed_lately(const Contact& contact, MonotonicTime now) const noexcept;
  void update_spring_budget(MonotonicTime now) noexcept;
  void raise_springs(Duration dt) noexcept;
  // Not only since this step.
  [[nodiscard]] bool goes_on_pressing(const Contact& contact) const noexcept;
  [[nodiscard]] double rise_m(const Contact& contact, Duration dt) const noexcept;
  [[nodiscard]] double price_joule(const Contact& contact, double by_m) const noexcept;
  [[nodiscard]] double sum_of_prices_joule(Duration dt) const noexcept;

  GhostPointSettings settings_;
  double hysteresis_m_;
  ConstraintAge age_;
  CoordinateFrame frame_;
  ContactList contacts_{};
  // Of the touch that lasts: the largest offset, squared, and what its coordinate spring gave.
  double touch_offset_m2_{0};
  double spring_spent_joule_{0};
  Position3 last_hand_{};
  std::uint64_t sequence_{0};
  std::uint64_t applied_reply_{0};
  std::uint32_t session_{0};
  std::uint32_t restarts_{0};  // calls of reset()
  bool has_set_{false};
  GhostPointCounters counters_{};
};

}  // namespace thimble::coupling
