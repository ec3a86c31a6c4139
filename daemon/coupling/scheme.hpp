#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/buffer_zone_arm.hpp"
#include "daemon/coupling/buffer_zone_world.hpp"
#include "daemon/coupling/composite_arm.hpp"
#include "daemon/coupling/constraint_plane_arm.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"
#include "daemon/coupling/remote_force_arm.hpp"
#include "daemon/coupling/spring_damper_arm.hpp"
#include "daemon/coupling/wave_arm.hpp"
#include "daemon/coupling/world_coupling.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"

namespace thimble::coupling {

// Which scheme, and the two halves of it. Thread: all of this is pure, any thread; what makes a
// half allocates: control plane, not RT. Ownership: a half is the caller's.
enum class Scheme : std::uint8_t {
  GhostPoint,       // "ghost-point": thesis 3.7, corrected
  ThesisLiteral,    // "thesis-literal": the printed client with its defects
  RemoteForce,      // "remote-force": thesis 3.2
  SpringDamper,     // "spring-damper": thesis 3.4
  Wave,             // "wave": thesis 3.5
  ConstraintPlane,  // "constraint-plane": thesis 3.7.2
  BufferZone,       // "buffer-zone": thesis 3.6
  Composite,        // "composite": our own, the ghost point with a map
};
inline constexpr std::array kSchemes{
    Scheme::GhostPoint, Scheme::ThesisLiteral,   Scheme::RemoteForce, Scheme::SpringDamper,
    Scheme::Wave,       Scheme::ConstraintPlane, Scheme::BufferZone,  Scheme::Composite};
[[nodiscard]] std::string_view to_string(Scheme scheme) noexcept;
// InvalidArgument names what was expected.
[[nodiscard]] Result<Scheme> parse_scheme(std::string_view text);

// Whether it has a world half of its own, whose answers the datagrams of 1999 do not carry.
[[nodiscard]] bool has_own_world_half(Scheme scheme) noexcept;

// Whether the hand's force is computed in the world alone, so that a guard can stand at both ends
// (TwoPortArm, TwoPortWorld). `force_at` is that of spring-damper.
[[nodiscard]] bool is_force_of_world(Scheme scheme, ForceAt force_at) noexcept;

// Of every scheme; each takes its own, composite those of the ghost point, which it is with a map,
// and thesis-literal of them only the constraint age: its other numbers are printed.
struct SchemeSettings {
  GhostPointSettings ghost_point{};
  RemoteForceSettings remote_force{};
  SpringDamperSettings spring_damper{};
  WaveSettings wave{};
  ConstraintPlaneSettings constraint_plane{};
  BufferZoneSettings buffer_zone{};
};

// The arm half of `scheme`. Control plane: allocates.
[[nodiscard]] std::unique_ptr<ArmCoupling> make_arm_coupling(Scheme scheme,
                                                             const SchemeSettings& settings);

// Of every world half that is a scheme's own; each takes its own.
struct WorldHalfSettings {
  ForceAt force_at{ForceAt::World};
  BufferZoneWorldSettings buffer_zone{};
};

// The world half of a scheme that has its own, in `world`, which must outlive it. Sessions are
// numbered as by GhostPointWorld. Control plane: allocates. InvalidArgument: `scheme` has none.
[[nodiscard]] Result<std::unique_ptr<WorldCoupling>> make_own_world_half(
    Scheme scheme, const WorldHalfSettings& settings, world::World& world,
    std::uint32_t first_session);

}  // namespace thimble::coupling
