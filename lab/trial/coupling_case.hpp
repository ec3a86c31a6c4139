#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "daemon/coupling/scheme.hpp"
#include "daemon/link/send_gate.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"
#include "lab/trial/trial_loop.hpp"

namespace thimble::lab {

// Where passivity is watched, with the settings that a guard ships with.
enum class Guard : std::uint8_t {
  None,
  AtHand,    // PassivityGuard: `passivity = true`
  BothEnds,  // TwoPortArm and TwoPortWorld: `passivity = "two-port"`
};

// A coupling scheme with what is set of it, under the name that tables and plots give it.
struct CouplingCase {
  std::string name;
  coupling::Scheme scheme{coupling::Scheme::GhostPoint};
  coupling::SchemeSettings settings{};
  coupling::WorldHalfSettings world_half{};  // of a scheme that has its own
  link::SendMode mode{link::SendMode::Streamed};
  Guard guard{Guard::None};
  double deadband_m{0};  // of the link; 0: every sample is sent
};

// Whether a guard of that kind goes with the scheme: both ends need a force that the world tells.
[[nodiscard]] bool can_have(Guard guard, const CouplingCase& of) noexcept;

// Both halves of `of` at a link as `settings` says, but for its mode, which is that of the case.
// `world` must outlive the loop. Errors: the world half's; InvalidArgument: a guard that the scheme
// cannot have.
[[nodiscard]] Result<std::unique_ptr<TrialLoop>> make_trial(const CouplingCase& of,
                                                            world::World& world,
                                                            TrialLoop::Settings settings);

}  // namespace thimble::lab
