#include "daemon/session/combination.hpp"

namespace thimble::session {
namespace {

// Faces of cells lie across the axes; other worlds may turn theirs any way.
[[nodiscard]] bool has_cells(const world::World& world) noexcept { return world.grid() != nullptr; }

[[nodiscard]] Result<void> as_result(const std::optional<Refusal>& refusal) {
  if (!refusal) return {};
  return fail(Errc::Unsupported, refusal->key + ": " + refusal->reason);
}

}  // namespace

std::optional<Refusal> find_refusal(const world::World& world, const config::WorldConfig& said) {
  if (has_cells(world)) return std::nullopt;
  if (said.constraint_model == config::ConstraintModel::Simple) {
    return Refusal{"constraint_model", "\"simple\" works on cells, of which " +
                                           world.info().source + " has none; use \"ghost-point\""};
  }
  if (said.listen) {
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
