#pragma once

#include <memory>
#include <string>

#include "daemon/coupling/scheme.hpp"
#include "daemon/link/send_gate.hpp"
#include "daemon/world/world.hpp"
#include "hal/base/result.hpp"
#include "lab/trial/trial_loop.hpp"

namespace thimble::lab {

// A coupling scheme with what is set of it, under the name that tables and plots give it.
struct CouplingCase {
  std::string name;
  coupling::Scheme scheme{coupling::Scheme::GhostPoint};
  coupling::SchemeSettings settings{};
  coupling::WorldHalfSettings world_half{};  // of a scheme that has its own
  link::SendMode mode{link::SendMode::Streamed};
  bool is_guarded{false};  // by a PassivityGuard, as it ships
  double deadband_m{0};    // of the link; 0: every sample is sent
};

// Both halves of `of` at a link as `settings` says, but for its mode, which is that of the case.
// `world` must outlive the loop. Errors: the world half's.
[[nodiscard]] Result<std::unique_ptr<TrialLoop>> make_trial(const CouplingCase& of,
                                                            world::World& world,
                                                            TrialLoop::Settings settings);

}  // namespace thimble::lab
