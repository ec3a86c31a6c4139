#include "daemon/session/combination.hpp"

namespace thimble::session {
namespace {

// That models work on.
[[nodiscard]] bool has_grid(const world::World& world) noexcept { return world.grid() != nullptr; }

// Faces of cells lie across the axes; other worlds may turn theirs any way.
[[nodiscard]] bool has_cells(const world::World& world) noexcept {
  return world.info().cells[0] > 0;
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
  if (said.listen && world.may_fall_silent()) {
    return Refusal{"listen",
                   "a world on a board falls silent when the board fails, which the "
                   "datagrams of 1999 cannot say; name it as the world of an arm of "
                   "this configuration"};
  }
  if (said.listen && !has_cells(world)) {
    return Refusal{"listen", "the datagrams of 1999 carry faces across the axes only, " +
                                 world.info().source + " has others; name it as the world of " +
                                 "an arm of this configuration"};
  }
  return std::nullopt;
}

std::optional<Refusal> find_refusal(const world::World& world, const config::CouplingConfig& arm) {
  if (has_cells(world) || arm.scheme != config::CouplingScheme::ThesisLiteral) return std::nullopt;
  return Refusal{"coupling.scheme", "\"thesis-literal\" feels faces across the axes only, " +
                                        world.info().source + " has others; use \"ghost-point\""};
}

Result<void> check_combination(const world::World& world, const config::WorldConfig& said) {
  return as_result(find_refusal(world, said));
}

Result<void> check_combination(const world::World& world, const config::CouplingConfig& arm) {
  return as_result(find_refusal(world, arm));
}

std::optional<std::string> find_loss(const config::WorldConfig& said) {
  if (!said.listen || said.materials.empty()) return std::nullopt;
  return "world '" + said.name +
         "': arms of other hosts feel none of its materials: the datagrams of 1999 carry no "
         "surface";
}

}  // namespace thimble::session
