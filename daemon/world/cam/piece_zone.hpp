#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/world/cam/piece_sweep.hpp"
#include "daemon/world/cam/piece_task.hpp"

namespace thimble::world::cam {

// How far the shape may go along each way, found by its trail without moving it: the zone of thesis
// 3.6 around one cell, figure 3-4.
struct PieceZone {
  struct Way {
    int free{0};      // cells that it may go, of those looked at
    int touching{0};  // cells of it that lie on pieces one further; 0: it is free as far as looked
    bool operator==(const Way&) const = default;
  };
  CamAxes grasp{};                           // the grasp point that it is counted from
  int cells{0};                              // looked at along each way, as far as the space goes
  std::array<std::array<Way, 2>, 3> ways{};  // of each axis: towards its low end, its high end
  bool operator==(const PieceZone&) const = default;
};

// One way of it: the trail grows to what is known to be free, or to be expected so, and doubles
// from there. Counts are dear to read, so the first round tells only whether all is as expected: or
// free, where nothing is. Pure. Thread: one at a time. Errors: none; take() without a round is a
// mistake of the caller.
class FreeWay {
 public:
  struct Round {
    std::vector<int> kicks;  // of what runs ahead of the trail, which begins at the shape
    std::size_t counted{0};  // from this one on it is counted what the trail lies on
  };

  // `most`: cells to look at; `longest`: kick, at least 1; `free`: of them, known to be;
  // `expected`: where it is looked first whether just so many are.
  FreeWay(int most, int longest, int free, int expected) noexcept
      : longest_(longest), free_(free), beyond_(most + 1), expected_(expected) {}
  // One that is known.
  explicit FreeWay(PieceZone::Way known) noexcept
      : free_(known.free), beyond_(known.free + 1), touching_(known.touching) {}

  [[nodiscard]] bool is_over() const noexcept { return beyond_ - free_ <= 1; }
  // Not when it is over.
  [[nodiscard]] Round next();
  // The first of those counted at which the trail lay on something.
  void take(std::optional<SweepSearch::Hit> hit);
  // When it is over.
  [[nodiscard]] PieceZone::Way found() const noexcept { return {free_, touching_}; }

 private:
  int longest_{1};
  int free_;
  int beyond_;  // so far it is not free, or not looked at
  int expected_{-1};
  int touching_{0};
  bool is_first_round_{true};
  std::size_t counted_{0};    // of the round
  std::vector<int> reaches_;  // of its kicks
};

// Finds the zone around the grasp point as far as `cells`. What `zone` says from elsewhere along an
// axis is not looked for again; it holds until it is over. The shape must lie on nothing.
[[nodiscard]] std::unique_ptr<PieceTask> make_zone(const PieceContext& context,
                                                   std::optional<PieceZone>& zone, int cells);

}  // namespace thimble::world::cam
