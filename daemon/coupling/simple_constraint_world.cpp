#include "daemon/coupling/simple_constraint_world.hpp"

#include "daemon/coupling/tell.hpp"

namespace thimble::coupling {

Result<void> SimpleConstraintWorld::open(const HandSample& first) {
  if (!is_finite(first.hand)) return fail(Errc::InvalidArgument, "hand position is not finite");
  state_ = world::start_simple_constraints(grid_, first.hand);
  last_ = {};
  last_.session = next_session_++;
  return {};
}

ConstraintSet SimpleConstraintWorld::answer(const HandSample& sample, Duration /*dt*/) noexcept {
  if (!state_ || !is_finite(sample.hand)) return last_;
  tell(world::constrain_simply(grid_, *state_, sample.hand), sample, last_);
  return last_;
}

}  // namespace thimble::coupling
