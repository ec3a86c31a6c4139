#include "daemon/world/cam/piece_programs.hpp"

#include <algorithm>
#include <array>

namespace thimble::world::cam {
namespace {

using namespace cam_step;

constexpr CamRun kScan{};
constexpr CamRun kLatch{.is_scan = false, .takes_counts = true};
// With the table loaded last, and back to the rule of motion.
constexpr CamRun kScanWithTable{.swaps_tables = true};
constexpr CamRun kLatchAndSwapBack{.is_scan = false, .takes_counts = true, .swaps_tables = true};

[[nodiscard]] bool is_nowhere(const CamAxes& cells) noexcept { return cells == CamAxes{}; }

}  // namespace

CamAxes sum(const CamAxes& a, const CamAxes& b) noexcept {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

CamBox shape_box(const PieceContext& context) noexcept {
  const PieceState& state = context.state;
  const CamGeometry& space = context.settings.space;
  if (state.held == 0) return moved_by(space, {}, state.grasp);
  const CamBox& rested = state.boxes[static_cast<std::size_t>(state.held)];
  CamAxes way{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    way[axis] = state.grasp[axis] - state.held_from[axis];
  }
  return moved_by(space, rested, way);
}

CamAxes longest_kick(const PieceContext& context) noexcept {
  const CamGeometry& space = context.settings.space;
  CamAxes longest = cells_along(space);
  constexpr std::array kStrips{CamDivision::StripX, CamDivision::StripY, CamDivision::StripZ};
  for (std::size_t axis = 0; axis < longest.size(); ++axis) {
    // How a mesh is wired is the board's affair.
    const bool may_be_divided =
        space.division == CamDivision::Mesh || space.division == kStrips[axis];
    if (may_be_divided) longest[axis] = std::max(longest[axis] / context.modules, 1);
  }
  return longest;
}

void add_kick(CamSteps& steps, const CamAxes& cells) {
  steps.emplace_back(Kick{{{cell::kMoving, cells}}});
}

void add_shift(CamSteps& steps, const PieceContext& context, CamAxes left) {
  const CamAxes longest = longest_kick(context);
  while (!is_nowhere(left)) {
    CamAxes part{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      part[axis] = std::clamp(left[axis], -longest[axis], longest[axis]);
      left[axis] -= part[axis];
    }
    add_kick(steps, part);
    steps.emplace_back(Run{kScan});
  }
}

void add_count(CamSteps& steps, CamEvents what) {
  steps.emplace_back(Count{what, cell::kOverlap});
  steps.emplace_back(Run{kLatch});
  steps.emplace_back(Run{kScan});
  steps.emplace_back(Run{kLatch});
  steps.emplace_back(ReadCounts{});
}

void add_with_table(CamSteps& steps, const std::shared_ptr<const CamTable>& table, int part) {
  steps.emplace_back(LoadTable{table});
  if (part >= 0) steps.emplace_back(Fix{cell::kSelect, cell::selecting(part)});
  steps.emplace_back(Count{CamEvents::Table, cell::kSelect});
  steps.emplace_back(Run{kLatch});
  steps.emplace_back(Run{kScanWithTable});
  if (part >= 0) steps.emplace_back(Fix{});
  steps.emplace_back(Run{kLatchAndSwapBack});
  steps.emplace_back(ReadCounts{});
}

int overlapping(const CamAnswer& answer) noexcept {
  return static_cast<int>(answer.counts.at(0)[cell::kOverlapLayer]);
}

int grasped_part(const CamAnswer& answer) noexcept {
  int part = 0;
  for (int bit = 0; bit < cell::kNumberLayers; ++bit) {
    const int counted = cell::kSelectLayer + bit;
    const auto layer = static_cast<std::size_t>(counted);
    if (answer.counts.at(0)[layer] != 0) part |= 1 << bit;
  }
  return part;
}

}  // namespace thimble::world::cam
