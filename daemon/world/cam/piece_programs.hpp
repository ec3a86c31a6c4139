#pragma once

#include <memory>

#include "daemon/world/cam/piece_task.hpp"

// The parts of programs that tasks are made of. Pure.
namespace thimble::world::cam {

[[nodiscard]] CamAxes sum(const CamAxes& a, const CamAxes& b) noexcept;

// Around the shape as it is.
[[nodiscard]] CamBox shape_box(const PieceContext& context) noexcept;

// Along each axis, on any board of so many modules: where the space is divided, no longer than its
// part of it.
[[nodiscard]] CamAxes longest_kick(const PieceContext& context) noexcept;
// Of what moves; its scan has to follow.
void add_kick(CamSteps& steps, const CamAxes& cells);
// Any way, each kick with its scan, and none longer than a module may be.
void add_shift(CamSteps& steps, const PieceContext& context, CamAxes way);
// A scan whose overlaps are counted before the table, as the thesis's were, or after it; and a
// reading.
void add_count(CamSteps& steps, CamEvents what);
// A scan with another table, whose `select` is counted after it, and a reading; `part`: what the
// host says in `select`, unless it is negative.
void add_with_table(CamSteps& steps, const std::shared_ptr<const CamTable>& table, int part);

// What a reading of such a count says.
[[nodiscard]] int overlapping(const CamAnswer& answer) noexcept;
[[nodiscard]] inline bool overlaps(const CamAnswer& answer) noexcept {
  return overlapping(answer) != 0;
}
[[nodiscard]] int grasped_part(const CamAnswer& answer) noexcept;

}  // namespace thimble::world::cam
