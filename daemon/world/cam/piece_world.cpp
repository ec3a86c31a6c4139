#include "daemon/world/cam/piece_world.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace thimble::world::cam {
namespace {

[[nodiscard]] int sign(int n) noexcept { return n < 0 ? -1 : n > 0 ? 1 : 0; }

[[nodiscard]] CamAxes middle_of(const CamAxes& cells) noexcept {
  return {cells[0] / 2, cells[1] / 2, cells[2] / 2};
}

}  // namespace

Result<std::unique_ptr<PieceWorld>> PieceWorld::create(const PieceWorldSettings& settings,
                                                       PieceBoard::Opener opener,
                                                       PieceLayout layout, const Clock& clock) {
  if (!std::isfinite(settings.workspace_m) || settings.workspace_m <= 0) {
    return fail(Errc::InvalidArgument,
                settings.source + ": workspace: is not a length greater than 0");
  }
  if (!std::isfinite(settings.pressure.newton_per_m) || settings.pressure.newton_per_m < 0) {
    return fail(Errc::InvalidArgument,
                settings.source + ": pressure: is not a stiffness of 0 and more");
  }
  if (layout.size() != settings.pieces.space.cells()) {
    return fail(Errc::InvalidArgument, settings.source + ": the layout is of another space");
  }
  // The constructor is private, so make_unique cannot reach it.
  return std::unique_ptr<PieceWorld>(
      new PieceWorld(settings, std::move(opener), std::move(layout), clock));
}

PieceWorld::PieceWorld(const PieceWorldSettings& settings, PieceBoard::Opener opener,
                       PieceLayout layout, const Clock& clock)
    : board_(std::move(opener), settings.pieces, std::move(layout),
             middle_of(cells_along(settings.pieces.space))),
      clock_(&clock),
      cells_(cells_along(settings.pieces.space)),
      pressure_(settings.pressure) {
  info_.source = settings.source;
  info_.cell_m = settings.workspace_m / *std::max_element(cells_.begin(), cells_.end());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    info_.cells[axis] = static_cast<std::uint32_t>(cells_[axis]);
    info_.extent_m[axis] = cells_[axis] > 1 ? cells_[axis] * info_.cell_m : 0;
  }
}

Result<ProbeId> PieceWorld::add_probe(Position3 hand) {
  if (!is_finite(hand)) return fail(Errc::InvalidArgument, "probe: the hand's place is not finite");
  if (probe_) return fail(Errc::Busy, info_.source + ": its one grasp point is taken");
  probe_ = ProbeId{++last_id_};
  hand_ = hand;
  begin_anew();
  return *probe_;
}

void PieceWorld::remove_probe(ProbeId probe) noexcept {
  if (probe_ != probe) return;
  probe_.reset();
  zone_cells_ = 0;
}

ProbeMotion PieceWorld::move_probe(ProbeId probe, Position3 hand, Duration /*dt*/) noexcept {
  if (probe_ != probe) return {hand, {}, false};
  if (is_finite(hand)) hand_ = hand;
  pump();
  return motion();
}

void PieceWorld::press(ProbeId probe, std::uint32_t buttons) noexcept {
  constexpr std::uint32_t kSelectOrDrop = 1U << 0;
  constexpr std::uint32_t kDelete = 1U << 1;
  if (probe_ != probe) return;
  if ((buttons & kSelectOrDrop) != 0) static_cast<void>(enqueue(std::nullopt));
  if ((buttons & kDelete) != 0) static_cast<void>(enqueue(PieceAction::Delete));
}

bool PieceWorld::act(ProbeId probe, HandAction action) noexcept {
  if (probe_ != probe) return false;
  const bool is_reset = action == HandAction::Reset;
  return enqueue(is_reset ? PieceAction::Reset : PieceAction::ToggleFree).has_value();
}

Result<std::uint64_t> PieceWorld::submit(PieceAction action) { return enqueue(action); }

Result<std::uint64_t> PieceWorld::enqueue(std::optional<PieceAction> action) {
  if (board_.trouble()) {
    finished_.push_back({++last_number_, PieceOutcome::NoBoard});
    return last_number_;
  }
  if (waiting_.size() >= kMaxWaiting) {
    return fail(Errc::Busy,
                info_.source + ": " + std::to_string(kMaxWaiting) + " actions wait for the board");
  }
  waiting_.push_back({++last_number_, action});
  return last_number_;
}

bool PieceWorld::withdraw(std::uint64_t number) {
  return std::erase_if(waiting_, [&](const Waiting& one) { return one.number == number; }) > 0;
}

std::vector<PieceWorld::Finished> PieceWorld::take_finished() {
  return std::exchange(finished_, {});
}

void PieceWorld::pump() {
  bool has_moved = false;  // one move a call: the hand is asked anew for the next
  while (true) {
    board_.pump(*clock_);
    note_end();
    if (board_.trouble()) give_up();
    if (!board_.is_ready()) return;
    if (!waiting_.empty() && !must_let_hand_go_first()) {
      begin_action();
      continue;
    }
    if (begin_picture()) continue;  // a hand that never rests would have none
    if (begin_zone()) continue;     // likewise
    if (!has_moved && begin_move(clock_->now())) {
      has_moved = true;
      has_shown_ = false;
    } else if (!waiting_.empty()) {
      begin_action();  // the hand rests, or there is none
    } else if (!begin_drift(clock_->now())) {
      return;
    }
  }
}

// What was under way and is over.
void PieceWorld::note_end() {
  if (const auto outcome = board_.take_outcome(); outcome && under_way_) {
    finished_.push_back({*std::exchange(under_way_, std::nullopt), *outcome});
  }
  // Put back to where they were, the grasp point is not where the hand is.
  const std::uint64_t resets = board_.counters().resets;
  if (std::exchange(resets_seen_, resets) != resets) begin_anew();
  if (!board_.is_ready() || !goal_) return;
  const CamAxes& grasp = board_.state().grasp;
  for (std::size_t axis = 0; axis < 3; ++axis) pressed_[axis] = sign((*goal_)[axis] - grasp[axis]);
  goal_.reset();
  has_looked_ = true;
}

// The grasp point is to be put where the hand is.
void PieceWorld::begin_anew() noexcept {
  is_placing_ = true;
  forget_hand();
}

// What was felt is of another hand, or of a board that was another one then.
void PieceWorld::forget_hand() noexcept {
  goal_.reset();
  last_try_.reset();
  pressed_ = {};
  has_looked_ = false;
}

// What was asked of a board that failed was asked where the hand was then.
void PieceWorld::give_up() {
  forget_hand();
  for (const Waiting& one : waiting_) finished_.push_back({one.number, PieceOutcome::NoBoard});
  waiting_.clear();
}

// A look takes half a second of a board over USB: clients who look again and again would be all
// that it does.
bool PieceWorld::must_let_hand_go_first() const {
  return probe_ && has_shown_ && waiting_.front().action == PieceAction::Look;
}

void PieceWorld::begin_action() {
  const Waiting next = waiting_.front();
  waiting_.pop_front();
  has_shown_ = has_shown_ || next.action == PieceAction::Look;
  under_way_ = next.number;
  const auto otherwise = board_.state().held != 0 ? PieceAction::Drop : PieceAction::Select;
  const PieceAction action = next.action.value_or(otherwise);
  last_try_.reset();
  board_.act(action, pressed_);
  if (action == PieceAction::Reset) begin_anew();
}

bool PieceWorld::begin_move(MonotonicTime now) {
  if (!probe_) return false;
  const CamAxes goal = cell_of(hand_);
  const CamAxes target = nearest_within(goal);
  const CamAxes& at = board_.state().grasp;
  const CamAxes way{target[0] - at[0], target[1] - at[1], target[2] - at[2]};
  const Try now_tried{target, board_.state()};
  if (!is_placing_ && last_try_ == now_tried && now - looked_at_ < kLookEvery) {
    // Nothing moves here but by us; beyond the edge the hand may have.
    for (std::size_t axis = 0; axis < 3; ++axis) pressed_[axis] = sign(goal[axis] - at[axis]);
    return false;
  }
  last_try_ = now_tried;
  looked_at_ = now;
  goal_ = goal;
  if (std::exchange(is_placing_, false) || way == CamAxes{}) {
    board_.place(way);
  } else {
    board_.move(way);
  }
  return true;
}

// What was missed while the board was busy or away is not made up for.
bool PieceWorld::begin_drift(MonotonicTime now) {
  if (!board_.settings().is_dynamic || (drift_at_ && now < *drift_at_)) return false;
  drift_at_ = now + kDriftEvery;
  board_.drift();
  return true;
}

// What the move before it has found is felt meanwhile.
bool PieceWorld::begin_picture() {
  const auto every = static_cast<std::uint64_t>(board_.settings().moves_a_picture);
  const std::uint64_t moves = board_.counters().moves;
  if (every == 0 || moves - moves_shown_ < every || board_.why_dark()) return false;
  moves_shown_ = moves;
  board_.show();
  return true;
}

bool PieceWorld::begin_zone() {
  const PieceState& state = board_.state();
  const bool is_held_by_pieces = !state.is_embedded && !state.is_free_motion;
  if (zone_cells_ == 0 || !has_looked_ || !is_held_by_pieces) return false;
  const auto& known = board_.zone();
  if (known && known->grasp == state.grasp && known->cells >= zone_cells_) return false;
  board_.look_around(zone_cells_);
  return true;
}

CamAxes PieceWorld::cell_of(Position3 hand) const noexcept {
  CamAxes cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (cells_[axis] == 1) continue;
    const double index = std::floor(hand[axis] / info_.cell_m + 0.5 * cells_[axis]);
    cell[axis] = static_cast<int>(std::clamp(index, -1.0, static_cast<double>(cells_[axis])));
  }
  return cell;
}

CamAxes PieceWorld::nearest_within(CamAxes cell) const noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = std::clamp(cell[axis], 0, cells_[axis] - 1);
  }
  return cell;
}

double PieceWorld::face_m(std::size_t axis, int index) const noexcept {
  return (2 * index - cells_[axis]) * (0.5 * info_.cell_m);
}

bool PieceWorld::is_overdue() const {
  const auto since = goal_ ? std::optional(looked_at_) : board_.running_since();
  return since && clock_->now() - *since > kOverdue;
}

ProbeMotion PieceWorld::motion() const {
  ProbeMotion motion{hand_, {}, board_.state().is_embedded};
  if (board_.trouble() || is_overdue() || !has_looked_) {
    motion.is_silent = true;
    return motion;
  }
  const CamAxes& grasp = board_.state().grasp;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (cells_[axis] == 1) continue;
    const double low = face_m(axis, grasp[axis]);
    const double high = face_m(axis, grasp[axis] + 1);
    motion.ghost[axis] = std::clamp(hand_[axis], low, high);
    if (pressed_[axis] == 0) continue;
    ContactPlane plane;
    plane.normal[axis] = pressed_[axis];
    plane.offset_m = pressed_[axis] > 0 ? high : -low;
    press_back(axis, plane, motion);
    motion.planes.push_back(plane);
  }
  return motion;
}

ZoneFaces PieceWorld::zone_faces() const noexcept {
  ZoneFaces faces;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (cells_[axis] == 1) continue;
    for (const int way : {1, -1}) {
      if (const auto face = zone_face(axis, way)) faces.push_back(*face);
    }
  }
  return faces;
}

std::optional<ContactPlane> PieceWorld::zone_face(std::size_t axis, int way) const noexcept {
  const int at = board_.state().grasp[axis];
  int free = way > 0 ? cells_[axis] - 1 - at : at;  // the edge
  int touching = 0;
  if (const auto& zone = board_.zone()) {
    const PieceZone::Way& said = zone->ways[axis][way > 0 ? 1 : 0];
    const int left = said.free + way * (zone->grasp[axis] - at);
    if (said.touching != 0 && left >= 0 && left < free) {
      free = left;
      touching = said.touching;
    }
  }
  if (free >= zone_cells_) return std::nullopt;
  ContactPlane plane;
  plane.normal[axis] = way;
  plane.offset_m = way * face_m(axis, at + way * free + (way > 0 ? 1 : 0));
  if (touching > 0 && pressure_.newton_per_m > 0) {
    plane.stiffness.newton_per_m = pressure_.newton_per_m * touching;
  }
  return plane;
}

void PieceWorld::press_back(std::size_t axis, ContactPlane& plane,
                            ProbeMotion& motion) const noexcept {
  const int touching = board_.state().touching[axis];
  if (pressure_.newton_per_m <= 0 || touching <= 0) return;
  plane.stiffness.newton_per_m = pressure_.newton_per_m * touching;
  motion.has_pressure = true;
  const double depth_m = plane.normal[axis] * hand_[axis] - plane.offset_m;
  if (depth_m <= 0) return;  // the hand has left it since the board looked
  motion.pressure[axis] = -plane.normal[axis] * (plane.stiffness.newton_per_m * depth_m);
}

}  // namespace thimble::world::cam
