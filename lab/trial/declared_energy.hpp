#pragma once

#include "lab/trial/coupling_case.hpp"

namespace thimble::lab {

// SOURCE: teleop.md 5, G2.
inline constexpr double kPassive_joule = 1e-3;

// Most that a scheme may give the hand, J: that, and of one that shifts its frame, for `contacts`
// and an offset of at most `offset_m`, N·½·K·H² + ½·k_o·o² on top, with its own K, H and k_o. A
// scheme without a coordinate spring has no k_o. Pure. SOURCE: teleop.md 5 (G2) and 2(e).
[[nodiscard]] double declared_joule(const CouplingCase& of, double contacts,
                                    double offset_m) noexcept;

}  // namespace thimble::lab
