#include "daemon/world/cam/piece_task.hpp"

#include <utility>

#include "daemon/world/cam/piece_programs.hpp"

namespace thimble::world::cam {
namespace {

class FarMove final : public PieceTask {
 public:
  FarMove(const PieceContext& context, const CamAxes& desired)
      : context_(context), desired_(desired) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    PieceState& state = context_.state;
    if (before != nullptr) {
      state.grasp = sum(state.grasp, desired_);
      state.is_embedded = overlaps(*before);
      state.touching = {};
      return std::nullopt;
    }
    CamSteps steps;
    add_shift(steps, context_, desired_);
    add_count(steps, CamEvents::Table);
    return steps;
  }

 private:
  PieceContext context_;
  CamAxes desired_;
};

class SearchMove final : public PieceTask {
 public:
  SearchMove(const PieceContext& context, const CamAxes& desired)
      : context_(context), search_(context.settings.search, desired), start_(context.state.grasp) {}

  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (phase_ == Phase::ToBeCounted) {
      phase_ = Phase::Counted;
      CamSteps count;
      add_count(count, CamEvents::Site);
      return count;
    }
    if (phase_ == Phase::Counted) {
      search_.take(overlapping(*before));
      context_.state.grasp = sum(start_, search_.actual());
    }
    phase_ = Phase::Unseen;
    const auto shift = search_.next();
    context_.state.grasp = sum(start_, search_.actual());
    if (!shift) {
      context_.state.touching = search_.touching();
      return std::nullopt;
    }
    CamSteps steps;
    if (shift->is_looked_at && !context_.settings.counts_apart) {
      phase_ = Phase::Counted;
      add_kick(steps, shift->cells);
      add_count(steps, CamEvents::Table);
      return steps;
    }
    if (shift->is_looked_at) phase_ = Phase::ToBeCounted;
    add_shift(steps, context_, shift->cells);
    return steps;
  }

 private:
  enum class Phase { Unseen, ToBeCounted, Counted };
  PieceContext context_;
  PieceSearch search_;
  CamAxes start_;
  Phase phase_{Phase::Unseen};
};

class Fill final : public PieceTask {
 public:
  Fill(const PieceContext& context, std::shared_ptr<const CamCells> cells)
      : context_(context), cells_(std::move(cells)) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before != nullptr) {
      context_.state.is_embedded = overlaps(*before);
      return std::nullopt;
    }
    using namespace cam_step;
    CamSteps steps{LoadTable{context_.tables.overlap},
                   Run{{.is_scan = false, .swaps_tables = true}}, WriteCells{cells_}};
    add_count(steps, CamEvents::Table);
    return steps;
  }

 private:
  PieceContext context_;
  std::shared_ptr<const CamCells> cells_;
};

class Picture final : public PieceTask {
 public:
  explicit Picture(int slice) : slice_(slice) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before == nullptr) return CamSteps{cam_step::Show{slice_}};
    return std::nullopt;
  }

 private:
  int slice_;
};

class Look final : public PieceTask {
 public:
  Look(const PieceContext& context, PieceLayout& picture) : context_(context), picture_(picture) {}
  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before == nullptr) return CamSteps{cam_step::ReadCells{}};
    const CamCells& cells = before->cells.at(0);
    const int held = context_.state.held;
    const bool is_dynamic = context_.settings.is_dynamic;
    const unsigned particles = is_dynamic ? cell::kParticles : 0U;
    const unsigned beside = is_dynamic ? particles | cell::kDice : 0U;
    picture_.resize(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool is_held = held != 0 && (cells[i] & cell::kShape) != 0;
      const auto bits = static_cast<std::uint16_t>(cells[i] & ~beside);
      const int seen = is_held ? held : cell::part_of(bits);
      const bool is_particle = seen == 0 && (cells[i] & particles) != 0;
      picture_[i] = is_particle ? kParticleSeen : static_cast<std::uint8_t>(seen);
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<PieceOutcome> outcome() const override {
    return PieceOutcome::Looked;
  }

 private:
  PieceContext context_;
  PieceLayout& picture_;
};

}  // namespace

std::unique_ptr<PieceTask> make_picture(const PieceContext& context) {
  return std::make_unique<Picture>(context.state.grasp[2]);
}

std::unique_ptr<PieceTask> make_look(const PieceContext& context, PieceLayout& picture) {
  return std::make_unique<Look>(context, picture);
}

std::unique_ptr<PieceTask> make_move(const PieceContext& context, const CamAxes& desired) {
  const bool is_far = context.state.is_free_motion || context.state.is_embedded;
  if (is_far) return std::make_unique<FarMove>(context, desired);
  const SearchKind search = context.settings.search;
  const bool sweeps = search == SearchKind::Sweep || search == SearchKind::BoundedSweep;
  if (sweeps) return make_sweep(context, desired);
  return std::make_unique<SearchMove>(context, desired);
}

std::unique_ptr<PieceTask> make_placing(const PieceContext& context, const CamAxes& desired) {
  return std::make_unique<FarMove>(context, desired);
}

std::unique_ptr<PieceTask> make_fill(const PieceContext& context,
                                     std::shared_ptr<const CamCells> cells) {
  return std::make_unique<Fill>(context, std::move(cells));
}

}  // namespace thimble::world::cam
