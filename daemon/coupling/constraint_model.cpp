#include "daemon/coupling/constraint_model.hpp"

#include "daemon/coupling/ghost_point_world.hpp"
#include "daemon/coupling/simple_constraint_world.hpp"

namespace thimble::coupling {

Result<std::unique_ptr<WorldCoupling>> make_world_coupling(ConstraintModel model,
                                                           world::World& world,
                                                           std::uint32_t first_session) {
  if (model == ConstraintModel::GhostPoint) {
    return std::make_unique<GhostPointWorld>(world, first_session);
  }
  if (world.grid() == nullptr) {
    return fail(Errc::Unsupported, world.info().source +
                                       ": the constraint model \"simple\" works on cells, of which "
                                       "this world has none; use \"ghost-point\"");
  }
  return std::make_unique<SimpleConstraintWorld>(*world.grid(), first_session);
}

}  // namespace thimble::coupling
