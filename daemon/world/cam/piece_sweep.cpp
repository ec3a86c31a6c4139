#include "daemon/world/cam/piece_sweep.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "daemon/world/cam/piece_programs.hpp"

namespace thimble::world::cam {

std::optional<SweepSearch::Round> SweepSearch::next() {
  if (!is_trying_ && !begin_attempt()) return std::nullopt;
  Round round{owed(), {}};
  stands_ = free_;
  reaches_.clear();
  for (int reach = 0; reach < beyond_ - 1;) {
    CamAxes kick{};
    const int by = std::min(reach + 1, beyond_ - 1 - reach);
    kick[axis_] = way_ * by;
    round.kicks.push_back(kick);
    reaches_.push_back(reach += by);
  }
  return round;
}

CamAxes SweepSearch::touching() const noexcept {
  CamAxes touching{};
  for (std::size_t axis = 0; axis < touching.size(); ++axis) {
    if (free_[axis] != desired_[axis]) touching[axis] = touching_[axis];
  }
  return touching;
}

void SweepSearch::take(std::optional<Hit> hit) {
  const int free = !hit ? reaches_.back() : hit->kick == 0 ? 0 : reaches_[hit->kick - 1];
  if (hit) {
    has_met_ = true;
    cells_ = hit->cells;
  }
  beyond_ = (hit ? reaches_[hit->kick] : beyond_) - free;
  free_[axis_] += way_ * free;
  if (beyond_ == 1) end_attempt();
}

CamAxes SweepSearch::owed() const noexcept {
  return {free_[0] - stands_[0], free_[1] - stands_[1], free_[2] - stands_[2]};
}

bool SweepSearch::begin_attempt() noexcept {
  const std::size_t first = axis_;
  for (std::size_t turn = 0; turn < desired_.size(); ++turn) {
    axis_ = (first + turn) % desired_.size();
    const int left = desired_[axis_] - free_[axis_];
    // Where it was stuck it still is, unless it has moved along another axis since.
    if (left == 0 || stuck_[axis_] == free_) continue;
    way_ = left < 0 ? -1 : 1;
    is_trying_ = true;
    has_met_ = false;
    beyond_ = 1 + std::min(std::abs(left), longest_[axis_]);
    return true;
  }
  return false;
}

void SweepSearch::end_attempt() noexcept {
  is_trying_ = false;
  if (!has_met_) return;
  stuck_[axis_] = free_;
  // Of all that the last hit's trail ran over, only its end is not free.
  touching_[axis_] = cells_;
}

namespace {

using namespace cam_step;

constexpr CamRun kScan{};
constexpr CamRun kScanAndSwap{.swaps_tables = true};
constexpr CamRun kCopyAndScan{.takes_counts = true};
constexpr CamRun kCopy{.is_scan = false, .takes_counts = true};

class SweepMove final : public PieceTask {
 public:
  SweepMove(const PieceContext& context, const CamAxes& desired)
      : context_(context), search_(desired, longest_kick(context)), start_(context.state.grasp) {
    if (context.settings.search != SearchKind::BoundedSweep) return;
    // One box for the whole of it: what a round leaves behind is cleared by the next one's first
    // scan, or by the last of all.
    box_ = swept_by(context.settings.space, shape_box(context), desired);
  }

  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before != nullptr) {
      context_.state.grasp = sum(start_, search_.stands());
      if (is_ending_) {
        context_.state.grasp = sum(context_.state.grasp, search_.owed());
        return std::nullopt;
      }
      context_.is_sweep_ready = true;
      search_.take(first_hit(*before));
    }
    if (const auto round = search_.next()) return sweep(*round);
    context_.state.touching = search_.touching();
    if (!is_sweeping_) return std::nullopt;
    return end();
  }

 private:
  [[nodiscard]] static std::optional<SweepSearch::Hit> first_hit(const CamAnswer& answer) {
    for (std::size_t i = 0; i < answer.counts.size(); ++i) {
      const auto cells = answer.counts[i][cell::kHitLayer];
      if (cells != 0) return SweepSearch::Hit{i, static_cast<int>(cells)};
    }
    return std::nullopt;
  }
  // Counters are copied and cleared by the scan behind the one that they are of.
  [[nodiscard]] CamSteps sweep(const SweepSearch::Round& round) {
    CamSteps steps;
    if (!context_.is_sweep_ready) steps.emplace_back(LoadTable{context_.tables.sweep});
    if (box_) steps.emplace_back(Within{box_});
    steps.emplace_back(Fix{cell::kBegins, cell::kBegins});
    steps.emplace_back(Count{CamEvents::Table, cell::kHit});
    add_kick(steps, round.shift);
    steps.emplace_back(Run{is_sweeping_ ? kScan : kScanAndSwap});
    is_sweeping_ = true;
    steps.emplace_back(Fix{cell::kBegins, 0});
    for (std::size_t i = 0; i < round.kicks.size(); ++i) {
      steps.emplace_back(Kick{{{cell::kAhead, round.kicks[i]}}});
      steps.emplace_back(Run{kCopyAndScan});
      if (i > 0) steps.emplace_back(ReadCounts{});
    }
    steps.emplace_back(Run{kCopy});
    steps.emplace_back(ReadCounts{});
    return steps;
  }
  // The last of the way, by the rule of motion, which shows the pieces again.
  [[nodiscard]] CamSteps end() {
    is_ending_ = true;
    CamSteps steps{Fix{}};
    if (box_) steps.emplace_back(Within{box_});
    add_kick(steps, search_.owed());
    steps.emplace_back(Run{kScanAndSwap});
    return steps;
  }

  PieceContext context_;
  SweepSearch search_;
  CamAxes start_;
  std::optional<CamBox> box_;  // all that the trail can lie in
  bool is_sweeping_{false};
  bool is_ending_{false};
};

}  // namespace

std::unique_ptr<PieceTask> make_sweep(const PieceContext& context, const CamAxes& desired) {
  return std::make_unique<SweepMove>(context, desired);
}

}  // namespace thimble::world::cam
