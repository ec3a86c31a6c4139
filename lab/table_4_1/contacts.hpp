#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/result.hpp"
#include "lab/findings/findings.hpp"
#include "lab/trial/coupling_case.hpp"
#include "lab/trial/spread.hpp"

// Contacts with the walls of the thesis's box (4.1), learned of late, by the hundred.
namespace thimble::lab {

enum class HandKind : std::uint8_t {
  Kinematic,  // goes where it wants to at a constant speed, whatever it feels: teleop.md 4, H1
  Dynamic,    // a finger that gives way: H2
};

struct ContactRun {
  coupling::SchemeSettings settings{};
  link::SendMode mode{link::SendMode::Streamed};
  HandKind hand{HandKind::Kinematic};
  double speed_m_per_s{0.2};
  link::ImpairmentSettings impairment{};
  std::uint64_t contacts{1000};
  std::uint64_t seed{1};
};

struct ContactStatistics {
  Spread offset_m;          // length of the frame's offset when the contact is first felt
  Spread change_m;          // of the offset by that contact
  Spread penetration_m;     // of the true wall by the hand in the world, when it is first felt
  std::uint64_t at_end{0};  // contacts first felt while the hand was at the end of the arm's reach
  double travel_m{0};       // dynamic hand: from one contact to the opposite one, mean
};

// Ends early, with fewer contacts or none, where the hand is back before it could feel them:
// contact_criterion() judges that.
// Deterministic. Errors: none but what says that the box cannot be made.
[[nodiscard]] Result<ContactStatistics> run_contacts(const ContactRun& of);

// The numbers of the box and of both hands, but for their speed.
[[nodiscard]] std::vector<Parameter> contact_parameters();

}  // namespace thimble::lab
