#include "daemon/world/cam/piece_board.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "daemon/world/cam/piece_drift.hpp"
#include "daemon/world/cam/piece_repair.hpp"
#include "hal/base/check.hpp"

namespace thimble::world::cam {

std::string_view to_string(PieceOutcome outcome) noexcept {
  switch (outcome) {
    case PieceOutcome::Selected:
      return "selected";
    case PieceOutcome::Dropped:
      return "dropped";
    case PieceOutcome::Deleted:
      return "deleted";
    case PieceOutcome::FreeMotionOn:
      return "free motion is on";
    case PieceOutcome::FreeMotionOff:
      return "free motion is off";
    case PieceOutcome::WasReset:
      return "all pieces are as they were at first";
    case PieceOutcome::Looked:
      return "looked";
    case PieceOutcome::NothingThere:
      return "nothing there";
    case PieceOutcome::NoRoom:
      return "no room";
    case PieceOutcome::NothingHeld:
      return "no piece is held";
    case PieceOutcome::AlreadyHeld:
      return "a piece is held already";
    case PieceOutcome::BoardFailed:
      return "the board failed meanwhile";
    case PieceOutcome::NoBoard:
      return "the board does not work, so nothing was done";
  }
  return "unknown";
}

namespace {

// Gone, or not one for this world: what is opened next may be.
bool never_heals(Errc code) {
  return code == Errc::Disconnected || code == Errc::InvalidArgument || code == Errc::TooLarge;
}

// Counters have 25 bits, and no scan of ours counts a cell twice.
std::optional<Error> impossible_count(const CamAnswer& answer, const CamGeometry& space) {
  for (const CamCounts& counts : answer.counts) {
    const std::uint64_t most = *std::max_element(counts.begin(), counts.end());
    if (most <= space.cells()) continue;
    return Error{Errc::Malformed, "the board says what cannot be: it has counted " +
                                      std::to_string(most) + " of " +
                                      std::to_string(space.cells()) + " cells"};
  }
  return std::nullopt;
}

// Of a select, before the board is told to do it.
std::optional<Error> impossible_piece(const PieceState& state) {
  const int part = state.held_next.value_or(0);
  if (part == 0 || state.sizes[static_cast<std::size_t>(part)] != 0) return std::nullopt;
  return Error{Errc::Malformed, "the board says what cannot be: the hand is at piece " +
                                    std::to_string(part) + ", and there is none"};
}

}  // namespace

PieceBoard::PieceBoard(Opener opener, const PieceSettings& settings, PieceLayout layout,
                       const CamAxes& grasp)
    : opener_(std::move(opener)),
      settings_(settings),
      layout_(std::move(layout)),
      first_grasp_(grasp),
      tables_(make_piece_tables(settings.is_dynamic, settings.search != SearchKind::BoundedSweep)) {
  start_over();
}

void PieceBoard::pump(const Clock& clock) {
  const MonotonicTime begin = clock.now();
  for (int i = 0; i < kMostPrograms; ++i) {
    const MonotonicTime now = clock.now();
    if (now - begin >= kMostAtOnce) return;
    if (!board_ || phase_ == Phase::Closed) {
      if (!open(now)) return;
      continue;
    }
    if (!board_->is_running()) {
      if (!task_ || !go_on(nullptr, now)) return;
      continue;
    }
    const auto answer = board_->poll(now);
    if (!answer) {
      if (doing_ == Doing::Picture) darken(answer.error());
      fail_with(answer.error(), now);
      return;
    }
    if (!*answer) return;
    ++counters_.programs;
    timeouts_ = 0;
    if (!go_on(&**answer, now)) return;
  }
}

// Its registers and its memory may be anything.
bool PieceBoard::open(MonotonicTime now) {
  if (!is_due(now)) return false;
  if (!board_) {
    auto opened = opener_(now);
    if (!opened) return fail_with(opened.error(), now);
    board_ = *std::move(opened);
  }
  if (const auto laid_out = board_->lay_out(settings_.space); !laid_out) {
    return fail_with(laid_out.error(), now);
  }
  if (has_cells_) {
    phase_ = Phase::Reading;
    return play({cam_step::ReadCells{}}, now);
  }
  fill(cells_of(layout_, settings_, state_));
  return true;
}

bool PieceBoard::go_on(const CamAnswer* answer, MonotonicTime now) {
  if (answer != nullptr) {
    if (const auto why = impossible_count(*answer, settings_.space)) return fail_with(*why, now);
  }
  if (phase_ == Phase::Reading) {
    CamCells cells = answer->cells.at(0);
    if (settings_.is_dynamic) take_particles(cells);  // they are no numbers of pieces
    if (repair(cells, state_, settings_)) {
      ++counters_.repairs;
      fill(std::move(cells));
    } else {
      ++counters_.resets;
      start_over();
      fill(cells_of(layout_, settings_, state_));
    }
    return true;
  }
  const auto steps = task_->next(answer);
  if (const auto why = impossible_piece(state_)) {
    state_.held_next.reset();
    return fail_with(*why, now);
  }
  if (steps) return play(*steps, now);
  end_task();
  return false;
}

void PieceBoard::end_task() {
  const Doing done = std::exchange(doing_, Doing::Nothing);
  const auto outcome = phase_ == Phase::Filling ? PieceOutcome::WasReset : task_->outcome();
  task_.reset();
  if (phase_ == Phase::Filling) {
    phase_ = Phase::Working;
    has_cells_ = true;
    trouble_.reset();
    retry_at_.reset();
  }
  if (done == Doing::Action) outcome_ = outcome;
  if (done == Doing::Action) ++counters_.actions;
  if (done == Doing::Move) ++counters_.moves;
  if (done == Doing::Drift) ++counters_.drifts;
  if (done == Doing::Picture) ++counters_.pictures;
  if (done == Doing::Zone) ++counters_.zones;
}

bool PieceBoard::play(const CamSteps& steps, MonotonicTime now) {
  given_at_ = now;
  const auto started = board_->start(steps, settings_.patience, now);
  if (started) return true;
  // Only what cannot be is refused.
  const Errc code = started.error().code;
  const bool is_refused =
      code == Errc::Unsupported || code == Errc::InvalidArgument || code == Errc::TooLarge;
  if (doing_ != Doing::Picture || !is_refused) return fail_with(started.error(), now);
  darken(started.error());
  task_.reset();
  doing_ = Doing::Nothing;
  return false;
}

// What is felt goes before what is seen.
void PieceBoard::darken(const Error& why) {
  why_dark_ = why.in("nothing is shown on the board's monitor");
}

bool PieceBoard::fail_with(const Error& why, MonotonicTime now) {
  ++counters_.failures;
  // That it is looked for, or not yet open, says less than why it had to be.
  if (why.code != Errc::Busy || !trouble_) trouble_ = why;
  retry_at_ = now + kRetry;
  phase_ = Phase::Closed;
  task_.reset();
  zone_.reset();
  if (std::exchange(doing_, Doing::Nothing) == Doing::Action) outcome_ = PieceOutcome::BoardFailed;
  if (why.code == Errc::Timeout && ++timeouts_ == kMostTimeouts) {
    trouble_->message +=
        "; that was time " + std::to_string(timeouts_) + " in a row, the board is opened anew";
    close();
  }
  if (never_heals(why.code)) close();
  return false;
}

std::optional<MonotonicTime> PieceBoard::running_since() const noexcept {
  const bool is_running = board_ && board_->is_running();
  return is_running ? std::optional(given_at_) : std::nullopt;
}

void PieceBoard::close() {
  board_.reset();
  timeouts_ = 0;
  why_dark_.reset();
}

void PieceBoard::fill(CamCells cells) {
  if (settings_.is_dynamic) put_dice(cells);
  phase_ = Phase::Filling;
  is_sweep_ready_ = false;
  task_ = make_fill(context(), std::make_shared<const CamCells>(std::move(cells)));
}

void PieceBoard::start_over() {
  state_ = {.grasp = first_grasp_,
            .sizes = sizes_of(layout_),
            .boxes = boxes_of(settings_.space, layout_)};
}

void PieceBoard::move(const CamAxes& desired) {
  THIMBLE_CHECK(is_ready());
  doing_ = Doing::Move;
  task_ = make_move(context(), desired);
}

void PieceBoard::place(const CamAxes& desired) {
  THIMBLE_CHECK(is_ready());
  doing_ = Doing::Move;
  if (desired != CamAxes{}) zone_.reset();
  task_ = make_placing(context(), desired);
}

void PieceBoard::act(PieceAction action, const CamAxes& pressed) {
  THIMBLE_CHECK(is_ready());
  if (action != PieceAction::Look) {
    is_sweep_ready_ = false;  // its room is needed
    zone_.reset();
  }
  switch (action) {
    case PieceAction::Select:
      task_ = make_select(context(), pressed);
      break;
    case PieceAction::Drop:
      task_ = make_drop(context());
      break;
    case PieceAction::Delete:
      task_ = make_delete(context());
      break;
    case PieceAction::ToggleFree:
      task_ = make_toggle(context());
      break;
    case PieceAction::Look:
      task_ = make_look(context(), picture_);
      break;
    case PieceAction::Reset:
      start_over();
      fill(cells_of(layout_, settings_, state_));
      break;
  }
  doing_ = Doing::Action;
}

void PieceBoard::drift() {
  THIMBLE_CHECK(is_ready() && settings_.is_dynamic);
  doing_ = Doing::Drift;
  task_ = make_drift(context(), counters_.drifts);
}

void PieceBoard::show() {
  THIMBLE_CHECK(is_ready());
  doing_ = Doing::Picture;
  task_ = make_picture(context());
}

void PieceBoard::look_around(int cells) {
  THIMBLE_CHECK(is_ready() && !state_.is_embedded && !state_.is_free_motion);
  doing_ = Doing::Zone;
  task_ = make_zone(context(), zone_, cells);
}

std::optional<PieceOutcome> PieceBoard::take_outcome() noexcept {
  return std::exchange(outcome_, std::nullopt);
}

PieceContext PieceBoard::context() noexcept {
  return {settings_, tables_, state_, board_->info().modules, is_sweep_ready_};
}

}  // namespace thimble::world::cam
