#include "daemon/world/cam/live_world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace thimble::world::cam {
namespace {

// Ours: far beyond what a hand can feel, within what a step takes.
constexpr double kMostSteps_per_s = 1000;
constexpr double kMostPoke_cells = 64;

[[nodiscard]] bool is_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;  // false for what is no number
}

}  // namespace

Result<std::unique_ptr<LiveWorld>> LiveWorld::create(LiveSettings settings,
                                                     std::unique_ptr<Automaton> automaton) {
  const auto bad = [&](const char* what) {
    return fail(Errc::InvalidArgument, settings.source + ": " + what);
  };
  if (!is_within(settings.workspace_m, 1e-3, 1e3)) return bad("the workspace is 1 mm to 1 km wide");
  if (!is_within(settings.steps_per_s, 0, kMostSteps_per_s)) {
    return bad("there are 0 to 1000 steps a second");
  }
  if (!is_within(settings.poke_cells, 0.5, kMostPoke_cells)) {
    return bad("a poke reaches 0.5 to 64 cells far");
  }
  std::array<std::uint32_t, 3> cells{};
  std::uint64_t all = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells[axis] = std::uint32_t{1} << automaton->log2_cells()[axis];
    all *= cells[axis];
  }
  if (all < 64) return bad("a live world has 64 cells at least");
  auto grid = VoxelGrid::create(
      cells, settings.workspace_m / *std::max_element(cells.begin(), cells.end()));
  if (!grid) return tl::unexpected(grid.error().in(settings.source));
  // The constructor is private, so make_unique cannot reach it.
  return std::unique_ptr<LiveWorld>(
      new LiveWorld(std::move(settings), std::move(automaton), *std::move(grid)));
}

LiveWorld::LiveWorld(LiveSettings settings, std::unique_ptr<Automaton> automaton, VoxelGrid grid)
    : settings_(std::move(settings)),
      automaton_(std::move(automaton)),
      cells_(std::move(grid), settings_.source),
      is_plane_(cells_.info().cells[2] == 1),
      info_(cells_.info()),
      seen_(cells_.grid()->words().size()),
      changed_(seen_.size()) {
  if (is_plane_) info_.extent_m[2] = 0;
  show();
}

// What the cells know of a hand: nothing of the third axis in a plane.
Position3 LiveWorld::within(Position3 p) const noexcept {
  if (is_plane_ && std::isfinite(p.z)) p.z = 0;
  return p;
}

Result<ProbeId> LiveWorld::add_probe(Position3 hand) {
  auto probe = cells_.add_probe(within(hand));
  if (!probe) return probe;
  fingers_.push_back({*probe, within(hand)});
  return probe;
}

void LiveWorld::remove_probe(ProbeId probe) noexcept {
  cells_.remove_probe(probe);
  std::erase_if(fingers_, [&](const Finger& finger) { return finger.probe == probe; });
}

ProbeMotion LiveWorld::move_probe(ProbeId probe, Position3 hand, Duration dt) noexcept {
  ProbeMotion motion = cells_.move_probe(probe, within(hand), dt);
  for (Finger& finger : fingers_) {
    if (finger.probe == probe) finger.ghost = motion.ghost;
  }
  if (is_plane_ && is_finite(hand)) motion.ghost.z = hand.z;
  return motion;
}

void LiveWorld::press(ProbeId probe, std::uint32_t buttons) noexcept {
  constexpr std::uint32_t kTakeAway = 1U << 0;
  constexpr std::uint32_t kFill = 1U << 1;
  const auto finger = std::find_if(fingers_.begin(), fingers_.end(),
                                   [&](const Finger& one) { return one.probe == probe; });
  if (finger == fingers_.end() || (buttons & (kTakeAway | kFill)) == 0) return;
  const bool is_filled = (buttons & kTakeAway) == 0;
  const VoxelGrid& grid = *cells_.grid();
  const double reach_m = settings_.poke_cells * grid.cell_m();
  Cell first;
  Cell last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = grid.lower_index(axis, finger->ghost[axis] - reach_m);
    last[axis] = grid.lower_index(axis, finger->ghost[axis] + reach_m);
  }
  for (Cell at = first; at.z <= last.z; ++at.z) {
    for (at.y = first.y; at.y <= last.y; ++at.y) {
      for (at.x = first.x; at.x <= last.x; ++at.x) {
        Displacement3 way;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          way[axis] = grid.face_m(axis, at[axis]) + 0.5 * grid.cell_m() - finger->ghost[axis];
        }
        if (norm(way) <= reach_m) cells_.set_cell(at, is_filled);
      }
    }
  }
}

std::optional<MonotonicTime> LiveWorld::pump(MonotonicTime now) {
  if (settings_.steps_per_s <= 0) return std::nullopt;
  const Duration period = from_seconds(1 / settings_.steps_per_s);
  if (!next_step_) next_step_ = now + period;
  if (now < *next_step_) return next_step_;
  tell_changes();
  automaton_->step();
  show();
  next_step_ = *next_step_ + period;
  if (*next_step_ <= now) {
    const auto late = static_cast<std::uint64_t>((now - *next_step_) / period) + 1;
    left_out_ += late;
    *next_step_ = now + period;
  }
  return next_step_;
}

AutomatonState LiveWorld::save() {
  tell_changes();
  return automaton_->save();
}

Result<void> LiveWorld::load(const AutomatonState& state) {
  if (const auto loaded = automaton_->load(state); !loaded) {
    return tl::unexpected(loaded.error().in(settings_.source));
  }
  show();
  ++loads_;
  return {};
}

void LiveWorld::tell_changes() {
  const auto now = cells_.grid()->words();
  bool is_changed = false;
  for (std::size_t i = 0; i < now.size(); ++i) {
    changed_[i] = now[i] ^ seen_[i];
    is_changed = is_changed || changed_[i] != 0;
  }
  if (is_changed) automaton_->write(changed_, now);
}

void LiveWorld::show() {
  automaton_->read(seen_);
  cells_.assign(seen_);
  mark();
}

void LiveWorld::mark_zone(std::int32_t cells) {
  if (cells <= zone_cells_) return;
  zone_cells_ = cells;
  tell_changes();
  mark();
}

void LiveWorld::mark() {
  zone_changes_.reset();
  if (zone_cells_ <= 0) return;
  zone_.resize(seen_.size());
  if (automaton_->mark_zone(zone_cells_, zone_)) zone_changes_ = cells_.changes();
}

bool LiveWorld::is_in_zone(Cell cell) const noexcept {
  if (zone_changes_ != cells_.changes()) return true;
  const VoxelGrid& grid = *cells_.grid();
  for (std::size_t axis = 0; axis < (is_plane_ ? 2U : 3U); ++axis) {
    const auto top = static_cast<std::int32_t>(grid.cells()[axis]) - 1;
    if (cell[axis] < zone_cells_ || cell[axis] > top - zone_cells_) return true;
  }
  const std::size_t bit = grid.bit_of(cell);
  return (zone_[bit / 64] >> (bit % 64) & 1) != 0;
}

}  // namespace thimble::world::cam
