#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "daemon/coupling/arm_coupling.hpp"
#include "daemon/coupling/ghost_point_arm.hpp"
#include "hal/base/result.hpp"

namespace thimble::coupling {

enum class Scheme : std::uint8_t {
  GhostPoint,     // "ghost-point": thesis 3.7, corrected
  ThesisLiteral,  // "thesis-literal": the printed client with its defects
};
[[nodiscard]] std::string_view to_string(Scheme scheme) noexcept;
// InvalidArgument names what was expected.
[[nodiscard]] Result<Scheme> parse_scheme(std::string_view text);

// The arm half of `scheme`. Of the settings thesis-literal takes only the constraint age: its
// other numbers are printed. Control plane: allocates.
[[nodiscard]] std::unique_ptr<ArmCoupling> make_arm_coupling(Scheme scheme,
                                                             const GhostPointSettings& settings);

}  // namespace thimble::coupling
