#include "lab/trial/coupling_case.hpp"

#include <utility>

#include "daemon/coupling/constraint_model.hpp"
#include "daemon/coupling/passivity_guard.hpp"
#include "daemon/coupling/two_port_arm.hpp"

namespace thimble::lab {
namespace {

Result<std::unique_ptr<coupling::WorldCoupling>> make_world_half(const CouplingCase& of,
                                                                 world::World& world) {
  if (coupling::has_own_world_half(of.scheme)) {
    return coupling::make_own_world_half(of.scheme, of.world_half, world, 1);
  }
  return coupling::make_world_coupling(coupling::ConstraintModel::GhostPoint, world, 1);
}

std::unique_ptr<coupling::ArmCoupling> make_arm_half(const CouplingCase& of) {
  auto half = coupling::make_arm_coupling(of.scheme, of.settings);
  const coupling::PassivitySettings settings;
  if (of.guard == Guard::AtHand) {
    return std::make_unique<coupling::PassivityGuard>(std::move(half), settings);
  }
  if (of.guard == Guard::BothEnds) {
    return std::make_unique<coupling::TwoPortArm>(std::move(half), settings);
  }
  return half;
}

}  // namespace

bool can_have(Guard guard, const CouplingCase& of) noexcept {
  return guard != Guard::BothEnds || coupling::is_force_of_world(of.scheme, of.world_half.force_at);
}

Result<std::unique_ptr<TrialLoop>> make_trial(const CouplingCase& of, world::World& world,
                                              TrialLoop::Settings settings) {
  if (!can_have(of.guard, of)) {
    return fail(Errc::InvalidArgument,
                of.name + ": a guard at both ends needs a force of the world");
  }
  auto world_half = make_world_half(of, world);
  if (!world_half) return tl::unexpected(world_half.error().in(of.name));
  settings.mode = of.mode;
  settings.deadband_m = of.deadband_m;
  return std::make_unique<TrialLoop>(make_arm_half(of), *std::move(world_half), settings);
}

}  // namespace thimble::lab
