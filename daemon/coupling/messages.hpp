#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "daemon/world/cell.hpp"
#include "daemon/world/cell_lattice.hpp"
#include "daemon/world/hand_action.hpp"
#include "daemon/world/near_cells.hpp"
#include "daemon/world/occupancy_block.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/static_vector.hpp"

// What the two halves of a coupling tell each other. Plain values, SI unless a name says otherwise.
// Thread: any; one copy is one thread's. RT: nothing here allocates. Errors: none here; who takes
// them from outside looks whether they are sound.
namespace thimble::coupling {

// How a surface feels; negative: the arm's configured default, of temperature nothing is known.
struct SurfaceProperties {
  Stiffness stiffness{-1};
  Damping damping{-1};
  double friction{-1};            // Coulomb's coefficient
  double temperature_kelvin{-1};  // for a stylus that can be warm; no force comes of it
  bool operator==(const SurfaceProperties&) const = default;
};

// A half-space the hand may not enter. World frame. `normal` points into the obstacle:
// admissible are the points q with dot(normal, q) <= offset_m (teleop.md 2(f)).
struct ConstraintPlane {
  Direction3 normal{};
  double offset_m{0};
  SurfaceProperties surface{};
  bool operator==(const ConstraintPlane&) const = default;
};

// Ours: the datagrams of 1999 carry at most three, a world of ours no more than
// world::kMaxContactPlanes; what tells the planes of a world checks that they fit.
inline constexpr std::size_t kMaxPlanes = 8;
using PlaneList = rt::StaticVector<ConstraintPlane, kMaxPlanes>;

// What the hand's tool is like. The arm half owns these numbers, so that both ends of a coupling
// compute with the same ones; a world half takes them as far as it finds them sound.
struct ToolProperties {
  Stiffness stiffness{0};  // of a wall that names none, or of the spring between hand and slave
  Damping damping{0};      // likewise; of waves the impedance b
  bool operator==(const ToolProperties&) const = default;
};

// Square root of a power, per axis: a wave variable (teleop.md 2(c)). √W.
using Wave3 = Vector3<struct WaveTag>;
// Time integral of a wave. √W·s.
using WaveDistance3 = Vector3<struct WaveDistanceTag>;

// Time integral of a force. N·s.
using Impulse3 = Vector3<struct ImpulseTag>;

// What was put into one direction of a wave channel since its epoch began: it only grows by what
// its sender adds, so of several messages the newest says all that the others did, and a lost one
// is made up for by the next. Per axis.
struct WaveSums {
  WaveDistance3 distance{};       // U = ∫u dt
  std::array<double, 3> joule{};  // E = ½∫u² dt, >= 0, never falls
  bool operator==(const WaveSums&) const = default;
};

// How often each of the first eight buttons was pressed, modulo 256, counted from any number: a
// press is in every later sample, too, so that none is lost with one.
using PressCounts = std::array<std::uint8_t, 8>;
// Likewise how often each world::HandAction was asked.
using ActionCounts = std::array<std::uint8_t, world::kHandActions>;

// Arm side to world side, once per report of the arm. World frame: q = p + o, the hand's position p
// in the arm's base frame displaced by the coordinate offset o.
struct HandSample {
  std::uint64_t sequence{0};   // from 1, +1 a step of the arm half: numbers may have gaps
  MonotonicTime sampled_at{};  // arm side's clock
  Position3 hand{};            // q
  // Of the tip, p' and not q': axes as above, what the shift of the frame adds is left out. Through
  // the servo's low-pass (servo/velocity_filter.hpp). The datagrams of 1999 do not carry it.
  Velocity3 velocity{};
  std::uint32_t buttons{0};
  std::uint64_t applied_reply{0};  // sequence of the newest ConstraintSet already in force
  // Changes when the arm half was reset: the ghost starts again at the hand. A carriage that
  // cannot tell leaves it.
  std::uint32_t restart{0};
  // Below: only for the schemes that compute at the far end; the datagrams of 1999 carry none of
  // it.
  ToolProperties tool{};
  WaveSums waves{};    // of u, since `restart` changed
  Impulse3 impulse{};  // of what the hand put in lately: WaveArm
  // Only of the arm half of a spring and damper: K_c·(x_s − x), what draws the hand to its far end.
  Force3 pull{};
  // Only of the arm halves that move a ghost of their own (BufferZoneArm, CompositeArm): where it
  // was, valid when has_ghost.
  Position3 ghost{};
  bool has_ghost{false};
  bool has_presses{false};  // a button was pressed since the servo began; `presses` else zeros
  PressCounts presses{};
  bool has_actions{false};  // one was asked since the servo began; `actions` else zeros
  ActionCounts actions{};
  // Only of CompositeArm: of the answers before applied_reply, which were in force, too: that of
  // number applied_reply − 1 − i where bit i is set.
  std::uint64_t applied_before{0};
  // Put in by the hand at the arm's port so far, J, for a guard between both ends (TwoPortWorld);
  // below 0: there is none.
  double energy_joule{-1};
  std::uint64_t epoch{0};  // MapNews::epoch of the cells through which that ghost came; 0: not said
};

// What the far end computed, for the schemes in which it does. World frame; which of the numbers
// mean something is the scheme's affair.
struct FarEnd {
  Force3 force{};           // on the hand
  Position3 slave{};        // where the mass is that follows the hand
  Velocity3 velocity{};     // of the slave
  WaveSums waves{};         // of the returning wave, since the session began
  bool is_pressing{false};  // the world pushes at the far end
  bool is_arm{false};       // another arm's hand, not a mass in a world
  ToolProperties tool{};    // of that arm: what it computes with; 0: nothing
};

// What the arm half does not know yet of the cells of a world (CompositeWorld).
struct MapNews {
  // Of the cells: another one when all of them were replaced at once, which voids what is known of
  // them; 0: the carriage cannot tell.
  std::uint64_t epoch{0};
  world::CellLattice lattice{};
  world::Cell ghost_cell{};  // where the ghost of the answer is
  bool is_plane{false};      // the third axis is free, and has one cell
  world::ToldBlocks blocks{};
};

// World side to arm side: everything that constrains the hand, replacing what was known.
struct ConstraintSet {
  std::uint64_t sequence{0};   // from 1, +1 a reply of one session
  std::uint64_t answers{0};    // HandSample::sequence it answers; 0: the carriage cannot tell
  MonotonicTime sampled_at{};  // of that sample, echoed; arm side's clock; 0 when unknown
  std::uint32_t session{0};    // changes when the world side restarted: old planes are void
  PlaneList planes{};
  Position3 ghost{};  // valid when has_ghost
  bool has_ghost{false};
  // Where it is among the cells of its world: on a face its position does not tell. Valid when
  // has_ghost_cell.
  world::Cell ghost_cell{};
  bool has_ghost_cell{false};
  bool is_embedded{false};  // the ghost sits in filled cells: pushed out or released
  FarEnd far{};             // valid when has_far
  bool has_far{false};
  // What is occupied near the ghost, which is in the cell in its middle; valid when has_near.
  world::NearCells near{};
  bool has_near{false};
  bool is_astray{false};  // the ghost that the sample told of is not where that of the world is
  MapNews map{};          // valid when has_map
  bool has_map{false};
  // Put in at the world's port so far, J (TwoPortArm); below 0: nobody counts it.
  double energy_joule{-1};
  // Valid when has_pressure: with what force, N, the cells of the faces that hold the hand (of the
  // schemes with a slave, the slave) press back on it, as its world reckons. Only to be shown: no
  // arm half makes a force of it, since the stiffness of the planes already has it.
  Force3 pressure{};
  bool has_pressure{false};
};

// Both cross threads and queues by copying, on the servo's side without an allocation.
static_assert(std::is_trivially_copyable_v<HandSample> && sizeof(HandSample) <= 320);
static_assert(std::is_trivially_copyable_v<ConstraintSet> && sizeof(ConstraintSet) <= 1536);

}  // namespace thimble::coupling
