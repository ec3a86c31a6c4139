#pragma once

#include <cstdint>

#include "daemon/world/cam/piece_layout.hpp"

// How particles of dynamic pieces drift (thesis 4.2.4; drift_rule()). Pure.
namespace thimble::world::cam {

struct DriftKicks {
  CamAxes forth{};  // one cell along one axis; particles that go back go the other way
  CamAxes dice{};
};
// Of the nth drift: the axes that have more than one cell by turns, the dice at random by up to
// `longest` along each; the same for the same n.
[[nodiscard]] DriftKicks drift_kicks(std::uint64_t n, const CamGeometry& space,
                                     const CamAxes& longest) noexcept;

// Puts dice into cells that have neither these nor particles: into about half, always the same.
void put_dice(CamCells& cells) noexcept;
// And takes both away.
void take_particles(CamCells& cells) noexcept;

}  // namespace thimble::world::cam
