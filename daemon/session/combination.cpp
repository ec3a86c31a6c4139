#include "daemon/session/combination.hpp"

namespace thimble::session {
namespace {

// Faces of cells lie across the axes; other worlds may turn theirs any way.
[[nodiscard]] bool has_cells(const world::World& world) noexcept { return world.grid() != nullptr; }

}  // namespace

Result<void> check_combination(const world::World& world, const config::WorldConfig& said) {
  if (has_cells(world)) return {};
  if (said.constraint_model == config::ConstraintModel::Simple) {
    return fail(Errc::Unsupported, "constraint_model: \"simple\" works on cells, of which " +
                                       world.info().source + " has none; use \"ghost-point\"");
  }
  if (said.listen) {
    return fail(Errc::Unsupported,
                "listen: the datagrams of 1999 carry faces across the axes only, " +
                    world.info().source + " has others; name it as the world of " +
                    "an arm of this configuration");
  }
  return {};
}

Result<void> check_combination(const world::World& world, const config::CouplingConfig& arm) {
  if (has_cells(world) || arm.scheme != config::CouplingScheme::ThesisLiteral) return {};
  return fail(Errc::Unsupported,
              "coupling.scheme: \"thesis-literal\" feels faces across the axes only, " +
                  world.info().source + " has others; use \"ghost-point\"");
}

}  // namespace thimble::session
