#include "daemon/session/combination.hpp"

#include "daemon/session/arm_settings.hpp"
#include "daemon/world/near_cells.hpp"
#include "daemon/world/voxel_grid.hpp"

namespace thimble::session {
namespace {

// That models work on.
[[nodiscard]] bool has_grid(const world::World& world) noexcept { return world.grid() != nullptr; }

// Faces of cells lie across the axes; other worlds may turn theirs any way.
[[nodiscard]] bool has_cells(const world::World& world) noexcept {
  return world.info().cells[0] > 0;
}

[[nodiscard]] std::optional<Refusal> refusal_of_zone(const world::World& world,
                                                     const config::CouplingConfig& arm) {
  const bool is_of_cells = world.felt_cells() != nullptr;
  const bool finds_faces = world.finds_zone_faces();
  if (!is_of_cells && finds_faces && arm.zone != config::CouplingZone::Faces) {
    return Refusal{"coupling.zone", "\"cells\" names those that the daemon has, those of " +
                                        world.info().source +
                                        " are its board's; use \"faces\", which that finds"};
  }
  if (!is_of_cells && !finds_faces && has_cells(world)) {
    return Refusal{"coupling.scheme",
                   "a \"buffer-zone\" is made of cells that the daemon has, those of " +
                       world.info().source +
                       " are its board's, which finds faces by search = \"trail\" alone; use "
                       "that, or \"ghost-point\""};
  }
  if (!is_of_cells && !finds_faces) {
    return Refusal{"coupling.scheme", "a \"buffer-zone\" is made of cells, of which " +
                                          world.info().source + " has none; use \"ghost-point\""};
  }
  const double most_m = world::kNearReach_cells * world.info().cell_m;
  if (world_half_settings(arm).buffer_zone.buffer_m <= most_m) return std::nullopt;
  return Refusal{"coupling.buffer_m", "a buffer zone reaches " +
                                          std::to_string(world::kNearReach_cells) +
                                          " cells far, which are " + std::to_string(most_m) +
                                          " m here; take less, or \"ghost-point\""};
}

[[nodiscard]] std::optional<Refusal> refusal_of_map(const world::World& world) {
  if (world.felt_cells() != nullptr) return std::nullopt;
  return Refusal{"coupling.scheme",
                 has_cells(world)
                     ? "the map of \"composite\" is of cells that the daemon has, those of " +
                           world.info().source + " are its board's; use \"ghost-point\""
                     : "the map of \"composite\" is of cells, of which " + world.info().source +
                           " has none; use \"ghost-point\""};
}

[[nodiscard]] Result<void> as_result(const std::optional<Refusal>& refusal) {
  if (!refusal) return {};
  return fail(Errc::Unsupported, refusal->key + ": " + refusal->reason);
}

}  // namespace

std::optional<Refusal> find_refusal(const world::World& world, const config::WorldConfig& said) {
  if (!has_grid(world) && said.constraint_model == config::ConstraintModel::Simple) {
    return Refusal{"constraint_model", "\"simple\" works on cells in three dimensions, which " +
                                           world.info().source + " has not; use \"ghost-point\""};
  }
  return std::nullopt;
}

std::optional<Refusal> find_refusal(const world::World& world, const config::CouplingConfig& arm) {
  if (arm.scheme == config::CouplingScheme::BufferZone) return refusal_of_zone(world, arm);
  if (arm.scheme == config::CouplingScheme::Composite) return refusal_of_map(world);
  const bool is_literal = arm.scheme == config::CouplingScheme::ThesisLiteral;
  if (!is_literal || world.has_faces_across_the_axes_only()) return std::nullopt;
  return Refusal{"coupling.scheme", "\"thesis-literal\" feels faces across the axes only, " +
                                        world.info().source + " has others; use \"ghost-point\""};
}

config::CouplingScheme choose_scheme(const world::World& world, const config::WorldConfig& said,
                                     const config::CouplingConfig& arm) {
  if (arm.scheme != config::CouplingScheme::Auto) return arm.scheme;
  const bool goes_with_a_map = world.felt_cells() != nullptr && said.materials.empty() &&
                               said.constraint_model == config::ConstraintModel::GhostPoint &&
                               arm.mode == config::CouplingMode::Streamed;
  return goes_with_a_map ? config::CouplingScheme::Composite : config::CouplingScheme::GhostPoint;
}

bool can_serve_1999(const world::World& world) noexcept {
  return world.has_faces_across_the_axes_only() && !world.may_fall_silent();
}

Result<void> check_combination(const world::World& world, const config::WorldConfig& said) {
  return as_result(find_refusal(world, said));
}

Result<void> check_combination(const world::World& world, const config::CouplingConfig& arm) {
  return as_result(find_refusal(world, arm));
}

std::optional<std::string> find_loss(const config::WorldConfig& said) {
  if (!said.is_listening() || said.materials.empty()) return std::nullopt;
  return "world '" + said.name +
         "': arms that speak the datagrams of 1999 feel none of its materials: those carry no "
         "surface";
}

}  // namespace thimble::session
