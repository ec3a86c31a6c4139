#pragma once

#include <cstdint>
#include <optional>

#include "daemon/link/impairment.hpp"
#include "daemon/link/link_key.hpp"
#include "daemon/link/send_gate.hpp"
#include "daemon/link/thesis_arm_end.hpp"
#include "daemon/link/thimble_arm_end.hpp"

namespace thimble::link {

// What an arm's end of either protocol is told, whatever carries it. A plain value; times in the
// types' own units, deadband_m in metres of the world frame. Thread: any; a copy is one thread's.
// Errors: none here; who reads them from outside (daemon/session) has checked them.
struct ArmEndSettings {
  enum class Protocol : std::uint8_t { Thesis, Thimble };
  SendMode mode{SendMode::Streamed};
  ImpairmentSettings impairment{};  // validated by the caller
  Protocol protocol{Protocol::Thesis};
  // Of Thimble alone, as in ThimbleArmEnd::Settings.
  std::optional<LinkKey> key{};
  ThimbleHalf half{.scheme = ShortName::of("ghost-point")};
  std::optional<ThimbleHalf> else_half{};
  double deadband_m{0};
};

// Pure, but for the numbers that a session begins with, which are the system's. Thread: control
// plane's; an end is then its link's thread's.
[[nodiscard]] ThesisArmEnd make_thesis_end(const ArmEndSettings& settings);
[[nodiscard]] ThimbleArmEnd make_thimble_end(const ArmEndSettings& settings);

}  // namespace thimble::link
