#include "daemon/world/cam/piece_zone.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "daemon/world/cam/piece_programs.hpp"

namespace thimble::world::cam {

FreeWay::Round FreeWay::next() {
  Round round;
  reaches_.clear();
  int reach = 0;
  const auto go = [&](int by) {
    round.kicks.push_back(by);
    reaches_.push_back(reach += by);
  };
  // The trail has gaps until here, all of them free.
  while (reach < free_) go(std::min(longest_, free_ - reach));
  round.counted = round.kicks.size();
  const int end = beyond_ - 1;
  const int expected = std::exchange(expected_, -1);
  bool is_as_expected = false;
  while (reach < end && !is_as_expected) {
    is_as_expected = reach == expected;
    int by = is_as_expected ? 1 : std::min({reach - free_ + 1, end - reach, longest_});
    if (reach < expected) by = std::min(by, expected - reach);
    go(by);
  }
  if (std::exchange(is_first_round_, false)) {
    const std::size_t ends = is_as_expected && expected > free_ ? 2 : 1;
    round.counted = round.kicks.size() - ends;
  }
  counted_ = round.counted;
  return round;
}

void FreeWay::take(std::optional<SweepSearch::Hit> hit) {
  if (!hit) {
    free_ = reaches_.back();
    return;
  }
  beyond_ = reaches_[hit->kick];
  if (hit->kick > counted_) free_ = reaches_[hit->kick - 1];
  // Of all that the last hit's trail ran over, only its end is not free.
  touching_ = hit->cells;
}

namespace {

using namespace cam_step;

constexpr CamRun kScanAndSwap{.swaps_tables = true};
constexpr CamRun kCopyAndScan{.takes_counts = true};
constexpr CamRun kCopy{.is_scan = false, .takes_counts = true};

class ZoneLook final : public PieceTask {
 public:
  ZoneLook(const PieceContext& context, std::optional<PieceZone>& zone, int cells)
      : context_(context), zone_(zone), cells_(cells) {
    const CamAxes longest = longest_kick(context);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t side = 0; side < 2; ++side) {
        sides_.push_back({axis, side == 0 ? -1 : 1, way_along(axis, side, longest[axis])});
      }
    }
  }

  [[nodiscard]] std::optional<CamSteps> next(const CamAnswer* before) override {
    if (before != nullptr) {
      context_.is_sweep_ready = true;
      take(*before);
    }
    under_way_.clear();
    for (Side& side : sides_) {
      if (!side.way.is_over()) under_way_.push_back({&side, side.way.next()});
    }
    if (!under_way_.empty()) return look();
    PieceZone found{context_.state.grasp, cells_, {}};
    for (const Side& side : sides_) {
      found.ways[side.axis][side.sign < 0 ? 0 : 1] = side.way.found();
    }
    zone_ = found;
    return std::nullopt;
  }

 private:
  struct Side {
    std::size_t axis{0};
    int sign{0};  // -1, +1
    FreeWay way;
  };
  struct Round {
    Side* side{nullptr};
    FreeWay::Round of;
  };

  // The space has an end there, and the grasp point does not leave it.
  [[nodiscard]] int most_along(std::size_t axis, std::size_t side) const {
    const int at = context_.state.grasp[axis];
    const int last = cells_along(context_.settings.space)[axis] - 1;
    return std::min(cells_, side == 0 ? at : last - at);
  }

  // Along the axis that the grasp point has moved on alone, and freely, a face is where it was.
  [[nodiscard]] FreeWay way_along(std::size_t axis, std::size_t side, int longest) const {
    const int most = most_along(axis, side);
    if (!zone_) return {most, longest, 0, -1};
    const PieceZone::Way& said = zone_->ways[axis][side];
    bool has_stayed_beside = true;
    for (std::size_t other = 0; other < 3; ++other) {
      const bool is_same = zone_->grasp[other] == context_.state.grasp[other];
      if (other != axis && !is_same) has_stayed_beside = false;
    }
    // A wall beside the way goes on, more often than not.
    if (!has_stayed_beside) return {most, longest, 0, said.touching != 0 ? said.free : -1};
    const int moved = context_.state.grasp[axis] - zone_->grasp[axis];
    const int free = said.free - (side == 0 ? -moved : moved);
    if (said.touching != 0 && free >= 0 && free < most) {
      return FreeWay({free, said.touching});
    }
    return {most, longest, std::clamp(free, 0, most), -1};
  }

  void take(const CamAnswer& answer) {
    std::size_t next = 0;
    for (const Round& round : under_way_) {
      std::optional<SweepSearch::Hit> hit;
      for (std::size_t i = round.of.counted; i < round.of.kicks.size(); ++i, ++next) {
        const auto cells = static_cast<int>(answer.counts.at(next)[cell::kHitLayer]);
        if (cells != 0 && !hit) hit = {i, cells};
      }
      round.side->way.take(hit);
    }
  }

  void add_within(CamSteps& steps, const CamBox& box) const {
    if (context_.settings.search == SearchKind::BoundedSweep) steps.emplace_back(Within{box});
  }

  // Counters are copied and cleared by the scan behind the one that they are of. A trail is cleared
  // by the scan that begins the next one, still within its own box; the last by the rule of motion,
  // which shows the pieces again.
  [[nodiscard]] CamSteps look() const {
    CamSteps steps;
    if (!context_.is_sweep_ready) steps.emplace_back(LoadTable{context_.tables.sweep});
    steps.emplace_back(Count{CamEvents::Table, cell::kHit});
    const CamBox shape = shape_box(context_);
    add_within(steps, shape);
    for (const Round& round : under_way_) {
      const bool is_first = &round == &under_way_.front();
      steps.emplace_back(Fix{cell::kBegins, cell::kBegins});
      steps.emplace_back(Run{is_first ? kScanAndSwap : kCopyAndScan});
      if (!is_first) steps.emplace_back(ReadCounts{});
      steps.emplace_back(Fix{cell::kBegins, 0});
      add_trail(steps, round, shape);
    }
    steps.emplace_back(Run{kCopy});
    steps.emplace_back(ReadCounts{});
    steps.emplace_back(Fix{});
    steps.emplace_back(Run{kScanAndSwap});
    return steps;
  }

  void add_trail(CamSteps& steps, const Round& round, const CamBox& shape) const {
    const Side& side = *round.side;
    const std::vector<int>& kicks = round.of.kicks;
    CamAxes swept{};
    swept[side.axis] = side.sign * std::accumulate(kicks.begin(), kicks.end(), 0);
    add_within(steps, swept_by(context_.settings.space, shape, swept));
    for (std::size_t i = 0; i < kicks.size(); ++i) {
      CamAxes kick{};
      kick[side.axis] = side.sign * kicks[i];
      steps.emplace_back(Kick{{{cell::kAhead, kick}}});
      steps.emplace_back(Run{kCopyAndScan});
      if (i > round.of.counted) steps.emplace_back(ReadCounts{});
    }
  }

  PieceContext context_;
  std::optional<PieceZone>& zone_;
  int cells_;
  std::vector<Side> sides_;
  std::vector<Round> under_way_;
};

}  // namespace

std::unique_ptr<PieceTask> make_zone(const PieceContext& context, std::optional<PieceZone>& zone,
                                     int cells) {
  return std::make_unique<ZoneLook>(context, zone, cells);
}

}  // namespace thimble::world::cam
