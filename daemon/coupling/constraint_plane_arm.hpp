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
#include "daemon/world/plane_projection.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::coupling {

// What becomes of a wall that the hand is already inside when it is told of.
enum class LateWalls : std::uint8_t {
  Offset,    // "offset": the frame is shifted and returns in free space (thesis 3.7)
  Recovery,  // "recovery": the wall slides to its true place under the finger
};

// What is not said here is the ghost point's (GhostPointSettings): walls of either scheme are as
// hard, and their frames go as far and return as fast.
struct ConstraintPlaneSettings {
  Stiffness stiffness{800};
  Damping damping{5};
  double friction{0};
  Stiffness max_stiffness{3000};
  Damping max_damping{20};
  double max_friction{1};
  LateWalls late_walls{LateWalls::Offset};
  // Of a wall on its way to its place: the ramp of teleop.md 3.
  Duration recovery_time{std::chrono::milliseconds(100)};
  double hysteresis_m{0.0005};  // upper bound; see effective_hysteresis_m() of told_planes.hpp
  double cell_m{0};             // edge of the world's cells; 0: it has none
  double relaxation_m_per_s{0.025};
  double max_offset_m{0.25};
  Duration redetection_guard{std::chrono::milliseconds(50)};
  ConstraintAgeSettings age{};
};

// For the status and for tests; since construction.
struct ConstraintPlaneCounters {
  std::uint64_t late_walls{0};       // replies for which frame or walls had to give way
  std::uint64_t news{0};             // planes that were new or had moved, told of inside or not
  std::uint64_t redetections{0};     // a plane pressed again within the guard: chatter
  std::uint64_t rejected_planes{0};  // not is_sound() (wall_penalty.hpp)
  bool operator==(const ConstraintPlaneCounters&) const = default;
};

// The arm half of constraint planes (thesis 3.7.2): a god-object that up to three planes of any
// angle hold at once, and a spring between it and the hand. SOURCE: Zilles and Salisbury; of Offset
// the thesis, of Recovery VRPN (Seeger): docs/references.md, teleop.md 2(f).
//
//   q = p + o + e
//   g = argmin ½|g − q|²  with  n_i·g ≤ d_i          world/plane_projection.hpp
//   F = −Π( K·(q − g) + B·v )                        K·(g − q) − B·v_n, where nothing attracts
//
// F     on the hand, N                  q  where the walls are felt from, m, world's frame
// p, v  tip, m, m/s, arm's frame        o  coordinate offset, m; what is sent is p + o
// g     proxy, m, world's frame         e  recovery: by how much the walls are still behind, m
// n, d  of the planes of the newest set: 1, m; n points into the obstacle
// K, B  N/m, N·s/m: those of the planes that hold g, weighed by their λ_i (one plane: its own;
//       ceilings max_stiffness, max_damping)
// Π     on the cone of the n_i that hold g: F never pulls along any of them. v_n is v's part in
//       their span. Π takes away damping only, so it gives the hand nothing.
//
// Friction µ of the planes, weighed likewise, acts along what the planes leave free: one plane, two
// ways; an edge, one; a corner, none (surface_touch.hpp).
//
// A wall learned of late, x_i = n_i·q − d_i > H: the least shift that leaves no plane deeper than
// it was felt, a new one H deep,
//
//   Δ = −N·(NᵀN)⁻¹·r,   r_i = n_i·q − d_i − H_i      over the planes that need it,
//
// and, where planes meet at so sharp an angle that |q − g| still grew by more than the H of each
// new one, along q − g until it did not. Of planes across the axes it is the ghost point's shift.
// Offset: o += Δ; o returns at relaxation_m_per_s, never into a plane held or remembered. Recovery:
// e += Δ, o stays 0; e returns evenly within recovery_time, whatever the finger does (practice of
// VRPN, teleop.md 2(f)). What a bound keeps back of Δ the walls yield till the hand gives room.
//
// Energy. U = ½·K·|q − g|² depends on q only, and a change of K adds nothing (wall_spring.hpp).
// Offset: each plane that is news gives the hand at most ½·K·H². Recovery: besides, what the walls
// do on their way, ∫F·|de| ≤ F_max·|Δ|, F_max the limiter's; it does inject.
//
// Silence of the world, a new session: as the ghost point. Planes that contradict each other push
// each for itself.
//
// Thread: one servo thread; counters() too. RT: reset(), step() THIMBLE_RT.
// Errors: as GhostPointArm.
class ConstraintPlaneArm final : public ArmCoupling {
 public:
  explicit ConstraintPlaneArm(const ConstraintPlaneSettings& settings = {}) noexcept;

  [[nodiscard]] const ConstraintPlaneCounters& counters() const noexcept { return counters_; }
  // e, and what the walls yield besides.
  [[nodiscard]] Displacement3 recovery() const noexcept { return recovery_.offset() + yield_; }

 private:
  THIMBLE_RT void restart(MonotonicTime now, Position3 tip) noexcept override;
  THIMBLE_RT ArmOutput advance(const ArmInput& input) noexcept override;

  // Held ones, of the newest set, stand first; the others are only remembered, as barriers that
  // relaxation must not cross.
  struct Face {
    ConstraintPlane plane{};
    bool is_barrier{true};
    bool is_pressing{false};
    bool has_pressed{false};
    MonotonicTime last_pressed{};
  };
  static constexpr std::size_t kMaxFaces = 2 * kMaxPlanes;
  using FaceList = rt::StaticVector<Face, kMaxFaces>;

  [[nodiscard]] ArmOutput refuse(const ArmInput& input) const noexcept;
  void describe(const ArmInput& input, ArmOutput& output) const noexcept;
  [[nodiscard]] Position3 rendered(Position3 tip) const noexcept;
  [[nodiscard]] world::PastPlanes past_held(Position3 hand) const noexcept;
  [[nodiscard]] bool names_what_is_held(const PlaneList& planes) const noexcept;
  void apply(const ConstraintSet& set, const ArmInput& input) noexcept;
  // How deep in `plane` the hand may stay; counts news.
  [[nodiscard]] double kept_m(const ConstraintPlane& plane, const ConstraintPlane* held,
                              Position3 hand, bool is_void) noexcept;
  void remember(Face face, const ArmInput& input) noexcept;
  void give_way(const world::PastPlanes& too_deep, double felt_m, std::uint64_t news,
                Position3 tip) noexcept;
  void yield(Displacement3 past) noexcept;
  void recover(Duration dt) noexcept;
  void relax(const ArmInput& input) noexcept;
  [[nodiscard]] Displacement3 free_way(Displacement3 wanted, Position3 hand) const noexcept;
  void press(const ArmInput& input, ArmOutput& output) noexcept;
  void note_pressing(const world::PlaneProjection& proxy, MonotonicTime now,
                     ArmOutput& output) noexcept;
  [[nodiscard]] SurfaceProperties surface_under(const world::PlaneProjection& proxy) const noexcept;
  [[nodiscard]] Force3 push(const world::PlaneProjection& proxy, double newton_per_m,
                            Velocity3 velocity, Damping damping) const noexcept;
  [[nodiscard]] Force3 rub_along(const world::PlaneProjection& proxy, const ArmInput& input,
                                 const SurfaceProperties& surface, double wall_newton) noexcept;

  ConstraintPlaneSettings settings_;
  double hysteresis_m_;
  ConstraintAge age_;
  CoordinateFrame frame_;
  CoordinateFrame recovery_;  // e
  double recovery_m_per_s_{0};
  Displacement3 yield_{};  // what neither of them could
  FaceList faces_{};
  std::size_t held_{0};
  WallSpring spring_{};
  Stiffness stiffness_{};  // of spring_
  bool is_touching_{false};
  Position3
      stuck_at_{};  // friction: arm's frame, so that no shift of the frame is felt along a wall
  Position3 last_tip_{};
  std::uint64_t sequence_{0};
  std::uint64_t applied_reply_{0};
  std::uint32_t session_{0};
  std::uint32_t restarts_{0};  // calls of reset()
  bool has_set_{false};
  ConstraintPlaneCounters counters_{};
};

}  // namespace thimble::coupling
