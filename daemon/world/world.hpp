#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/world/block_scene.hpp"
#include "daemon/world/cell.hpp"
#include "daemon/world/hand_action.hpp"
#include "daemon/world/sphere_scene.hpp"
#include "hal/base/geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/rt/static_vector.hpp"

namespace thimble::world {

class VoxelGrid;
class VoxelWorld;
namespace cam {
class LiveWorld;
class PieceWorld;
}  // namespace cam

struct ProbeId {
  std::uint32_t value{0};
  auto operator<=>(const ProbeId&) const = default;
};

// A face of the world that stops a ghost point. World frame. `normal` points into the
// obstacle; admissible: dot(normal, q) <= offset_m. Negative surface numbers: use the arm's.
struct ContactPlane {
  Direction3 normal{};
  double offset_m{0};
  Stiffness stiffness{-1};
  Damping damping{-1};
  double friction{-1};            // Coulomb's coefficient
  double temperature_kelvin{-1};  // negative: not known
  bool operator==(const ContactPlane&) const = default;
};

// Ours: cells hold a ghost by one face along each axis, the sphere by the ball and its floor; the
// rest is room for a world whose faces meet at any angle.
inline constexpr std::size_t kMaxContactPlanes = 8;

// World frame. At most two an axis.
using ZoneFaces = rt::StaticVector<ContactPlane, 6>;

// Ours: one probe is one arm of the daemon or one client of a datagram link.
inline constexpr std::size_t kMaxProbes = 8;

// World frame.
struct ProbeMotion {
  Position3 ghost{};  // where the ghost point is after the move
  // What holds it back from the hand; may be empty.
  rt::StaticVector<ContactPlane, kMaxContactPlanes> planes{};
  bool is_embedded{false};  // it sits in matter: pushed out or released
  bool is_silent{false};    // the world cannot say now: what it said last holds, and grows old
  Cell cell{};              // of the ghost, in worlds that have World::felt_cells()
  // Valid when has_pressure, in worlds that count the cells of a face: the force, N, with which
  // those press back on the hand where it was told to be. Only to be shown: what is felt comes of
  // the planes, whose stiffness has the count in it.
  Force3 pressure{};
  bool has_pressure{false};
};

// World frame. From the configuration and the volume file, if there is one; cells may change, these
// figures do not.
struct WorldInfo {
  std::string source;                    // e.g. "box:3"
  std::array<std::uint32_t, 3> cells{};  // 0 where the world has no cells
  double cell_m{0};
  std::array<double, 3> extent_m{};     // the world is centred on the origin; 0 where it has no end
  std::optional<SphereScene> sphere{};  // of a world that is one
  std::optional<BlockScene> block{};    // likewise, as it was made
};

// A world that ghost points move through. Every position is in the world frame: of a hand, the one
// that its HandSample says, coordinate offset included.
//
// Thread: one, the world's. Not RT; move_probe() and press() wait for nothing, and allocate only in
// worlds on a board.
class World {
 public:
  virtual ~World() = default;
  [[nodiscard]] virtual const WorldInfo& info() const noexcept = 0;
  // The cells it is made of, for models that work on them; nullptr where it has none.
  [[nodiscard]] virtual const VoxelGrid* grid() const noexcept { return nullptr; }
  // The cells that alone hold its probes, which a peer may be told of: what buffer zones are made
  // of. nullptr where there are none, or something else holds them, too. Those of is_plane() hold
  // along x and y; of z they have one, and it is free.
  [[nodiscard]] virtual const VoxelGrid* felt_cells() const noexcept { return grid(); }
  [[nodiscard]] virtual bool is_plane() const noexcept { return false; }
  // Somebody will ask whether cells are within `cells` of an occupied one, along each axis.
  virtual void mark_zone(std::int32_t /*cells*/) {}
  // False: no cell is occupied within as many as mark_zone() was told at most. Worlds that do not
  // mark their zone say true everywhere.
  [[nodiscard]] virtual bool is_in_zone(Cell /*cell*/) const noexcept { return true; }
  // Whether every face it tells of lies across an axis, which is all that the datagrams of 1999 can
  // say.
  [[nodiscard]] virtual bool has_faces_across_the_axes_only() const noexcept {
    return info().cells[0] > 0;
  }
  // Where its block is now; nothing where there is none.
  [[nodiscard]] virtual std::optional<Position3> block_center() const noexcept {
    return std::nullopt;
  }
  // How often all its cells were replaced at once since it was made, as by a file that was loaded:
  // what anybody knew of them is void, not only late.
  [[nodiscard]] virtual std::uint32_t loads() const noexcept { return 0; }
  // Filled ones, of those of its grid.
  [[nodiscard]] virtual std::size_t occupied_cells() const noexcept { return 0; }
  // Itself where its cells may be edited; nullptr where they may not, or there are none.
  [[nodiscard]] virtual VoxelWorld* editable() noexcept { return nullptr; }
  // Itself where there are pieces to select and drop; nullptr where there are none.
  [[nodiscard]] virtual cam::PieceWorld* pieces() noexcept { return nullptr; }
  // Itself where it changes step by step; nullptr where it does not.
  [[nodiscard]] virtual cam::LiveWorld* live() noexcept { return nullptr; }
  // Whether what it says may be ProbeMotion::is_silent.
  [[nodiscard]] virtual bool may_fall_silent() const noexcept { return false; }
  // The ghost starts at `hand` if that place is free, else at the nearest free place.
  // NotFound when the world has no free place, Busy when it has no room for another probe.
  [[nodiscard]] virtual Result<ProbeId> add_probe(Position3 hand) = 0;
  virtual void remove_probe(ProbeId probe) noexcept = 0;
  // Buttons that were just pressed, by their bits. Most worlds have nothing to do with them.
  virtual void press(ProbeId /*probe*/, std::uint32_t /*buttons*/) noexcept {}
  // Whether there is something here that act() does: who asks elsewhere is to be told so.
  [[nodiscard]] virtual bool has_actions() const noexcept { return false; }
  // False: not taken, since there is no such action here, no such probe, or no room for it now.
  [[nodiscard]] virtual bool act(ProbeId /*probe*/, HandAction /*action*/) noexcept {
    return false;
  }
  // Moves the ghost towards the hand as far as the world lets it; `dt` > 0 bounds push-out.
  // A hand that is not finite leaves the ghost where it is. An unknown probe: planes empty,
  // ghost at the hand.
  virtual ProbeMotion move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept = 0;

  // Whether it finds the faces of a zone itself, though nobody but it has its cells; else they are
  // looked for in its felt_cells().
  [[nodiscard]] virtual bool finds_zone_faces() const noexcept { return false; }
  // Of such a world: what would stop the ghost along both ways of each axis, as far as mark_zone()
  // was told, from where it was when the world looked last.
  [[nodiscard]] virtual ZoneFaces zone_faces() const noexcept { return {}; }
};

}  // namespace thimble::world
