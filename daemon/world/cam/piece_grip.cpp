#include <utility>
#include <vector>

#include "daemon/world/cam/piece_programs.hpp"
#include "daemon/world/cam/piece_task.hpp"

namespace thimble::world::cam {
namespace {

class Select final : public PieceTask {
 public:
  Select(const PieceContext& context, const CamAxes& pressed)
      : context_(context), start_(context.state.grasp) {
    // Where it lies, then along each axis that the hand presses; what lies beyond the world's wall
    // is at its other end.
    const CamAxes cells = cells_along(context.settings.space);
    places_.push_back({});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (pressed[axis] == 0) continue;
      CamAxes place{};
      place[axis] = pressed[axis] < 0 ? -1 : 1;
      const int there = start_[axis] + place[axis];
      if (there >= 0 && there < cells[axis]) places_.push_back(place);
    }
  }
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    PieceState& state = context_.state;
    if (outcome_) return std::nullopt;
    if (state.held != 0) {
      outcome_ = PieceOutcome::AlreadyHeld;
      return std::nullopt;
    }
    if (is_selecting_) return finish();
    if (before != nullptr) {
      const int part = grasped_part(*before);
      if (part != 0) return select(part);
    }
    return look_further();
  }
  [[nodiscard]] std::optional<PieceOutcome> outcome() const override { return outcome_; }

 private:
  void go_to(CamSteps& steps, const CamAxes& place) {
    add_shift(steps, context_, {place[0] - at_[0], place[1] - at_[1], place[2] - at_[2]});
    at_ = place;
  }
  [[nodiscard]] std::optional<CamSteps> look_further() {
    CamSteps steps;
    if (next_ == places_.size()) {
      outcome_ = PieceOutcome::NothingThere;
      go_to(steps, {});
      if (steps.empty()) return std::nullopt;
      return steps;
    }
    go_to(steps, places_[next_++]);
    add_with_table(steps, context_.tables.grasp, -1);
    return steps;
  }
  [[nodiscard]] CamSteps select(int part) {
    is_selecting_ = true;
    context_.state.grasp = sum(start_, at_);
    context_.state.held_from = context_.state.grasp;
    context_.state.held_next = part;
    CamSteps steps;
    add_with_table(steps, context_.tables.select, part);
    return steps;
  }
  [[nodiscard]] std::optional<CamSteps> finish() {
    PieceState& state = context_.state;
    state.held = *std::exchange(state.held_next, std::nullopt);
    state.is_embedded = false;
    outcome_ = PieceOutcome::Selected;
    return std::nullopt;
  }

  PieceContext context_;
  CamAxes start_;
  CamAxes at_{};  // from start_
  std::vector<CamAxes> places_;
  std::size_t next_{0};
  bool is_selecting_{false};
  std::optional<PieceOutcome> outcome_;
};

// Lets go of the held piece: where it is, or into nothing.
class Deposit final : public PieceTask {
 public:
  Deposit(const PieceContext& context, bool is_deleted)
      : context_(context), is_deleted_(is_deleted) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    PieceState& state = context_.state;
    if (phase_ == Phase::Begin && state.held == 0) return end(PieceOutcome::NothingHeld);
    if (phase_ == Phase::Begin && !is_deleted_) {
      phase_ = Phase::Looking;
      CamSteps steps;
      add_count(steps, CamEvents::Table);
      return steps;
    }
    if (phase_ == Phase::Looking && overlaps(*before)) return end(PieceOutcome::NoRoom);
    if (phase_ != Phase::Depositing) return deposit();
    return finish(*before);
  }
  [[nodiscard]] std::optional<PieceOutcome> outcome() const override { return outcome_; }

 private:
  enum class Phase { Begin, Looking, Depositing };

  std::nullopt_t end(PieceOutcome outcome) {
    outcome_ = outcome;
    return std::nullopt;
  }
  // And looks at what the grasp point lies on then.
  [[nodiscard]] CamSteps deposit() {
    phase_ = Phase::Depositing;
    context_.state.held_next = 0;
    context_.state.is_deleting = is_deleted_;
    CamSteps steps;
    add_with_table(steps, context_.tables.deposit, is_deleted_ ? 0 : context_.state.held);
    steps.pop_back();  // the table's counts mean nothing
    add_count(steps, CamEvents::Table);
    return steps;
  }
  std::nullopt_t finish(const CamAnswer& answer) {
    PieceState& state = context_.state;
    state.held_next.reset();
    const auto part = static_cast<std::size_t>(state.held);
    state.boxes[part] = shape_box(context_);
    state.is_deleting = false;
    if (is_deleted_) state.sizes[part] = 0;
    state.held = 0;
    state.is_embedded = overlaps(answer);
    return end(is_deleted_ ? PieceOutcome::Deleted : PieceOutcome::Dropped);
  }

  PieceContext context_;
  bool is_deleted_;
  Phase phase_{Phase::Begin};
  std::optional<PieceOutcome> outcome_;
};

class Toggle final : public PieceTask {
 public:
  explicit Toggle(const PieceContext& context) : context_(context) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before == nullptr) {
      CamSteps steps;
      add_count(steps, CamEvents::Table);
      return steps;
    }
    PieceState& state = context_.state;
    state.is_free_motion = !state.is_free_motion;
    state.is_embedded = overlaps(*before);
    return std::nullopt;
  }
  [[nodiscard]] std::optional<PieceOutcome> outcome() const override {
    return context_.state.is_free_motion ? PieceOutcome::FreeMotionOn : PieceOutcome::FreeMotionOff;
  }

 private:
  PieceContext context_;
};

}  // namespace

std::unique_ptr<PieceTask> make_toggle(const PieceContext& context) {
  return std::make_unique<Toggle>(context);
}

std::unique_ptr<PieceTask> make_select(const PieceContext& context, const CamAxes& pressed) {
  return std::make_unique<Select>(context, pressed);
}

std::unique_ptr<PieceTask> make_drop(const PieceContext& context) {
  return std::make_unique<Deposit>(context, /*is_deleted=*/false);
}

std::unique_ptr<PieceTask> make_delete(const PieceContext& context) {
  return std::make_unique<Deposit>(context, /*is_deleted=*/true);
}

}  // namespace thimble::world::cam
