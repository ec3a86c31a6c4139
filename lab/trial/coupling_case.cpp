#include "lab/trial/coupling_case.hpp"

#include <utility>

#include "daemon/coupling/constraint_model.hpp"
#include "daemon/coupling/passivity_guard.hpp"

namespace thimble::lab {
namespace {

Result<std::unique_ptr<coupling::WorldCoupling>> make_world_half(const CouplingCase& of,
                                                                 world::World& world) {
  if (coupling::has_own_world_half(of.scheme)) {
    return coupling::make_own_world_half(of.scheme, of.world_half, world, 1);
  }
  return coupling::make_world_coupling(coupling::ConstraintModel::GhostPoint, world, 1);
}

}  // namespace

Result<std::unique_ptr<TrialLoop>> make_trial(const CouplingCase& of, world::World& world,
                                              TrialLoop::Settings settings) {
  auto world_half = make_world_half(of, world);
  if (!world_half) return tl::unexpected(world_half.error().in(of.name));
  settings.mode = of.mode;
  settings.deadband_m = of.deadband_m;
  auto arm_half = coupling::make_arm_coupling(of.scheme, of.settings);
  if (of.is_guarded) {
    arm_half = std::make_unique<coupling::PassivityGuard>(std::move(arm_half),
                                                          coupling::PassivitySettings{});
  }
  return std::make_unique<TrialLoop>(std::move(arm_half), *std::move(world_half), settings);
}

}  // namespace thimble::lab
