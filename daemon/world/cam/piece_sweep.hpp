#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

// As PieceSearch, how far a shape gets, but with what the shape sweeps over: a trail that each scan
// makes twice as long, so that one scan looks at as many distances as all before it, and nothing is
// thin enough to be leapt over. Pure. Thread: one at a time. Errors: none; take() without a round
// is a mistake of the caller.
class SweepSearch {
 public:
  // First the shape moves, and its trail begins anew; then each kick of what runs ahead makes the
  // trail as much longer.
  struct Round {
    CamAxes shift{};
    std::vector<CamAxes> kicks;
  };

  // `longest`: kick along each axis, at least 1.
  SweepSearch(const CamAxes& desired, const CamAxes& longest) noexcept
      : desired_(desired), longest_(longest) {}

  // Nothing: it is over, but for owed().
  [[nodiscard]] std::optional<Round> next();
  // The first of the kicks by which the trail met something, counted from 0, and how many cells of
  // it lay on pieces then.
  struct Hit {
    std::size_t kick{0};
    int cells{0};
  };
  void take(std::optional<Hit> hit);
  // Where the shape stands, with the rounds that were given.
  [[nodiscard]] const CamAxes& stands() const noexcept { return stands_; }
  // How far it may still go from there.
  [[nodiscard]] CamAxes owed() const noexcept;
  // As PieceSearch::touching().
  [[nodiscard]] CamAxes touching() const noexcept;

 private:
  [[nodiscard]] bool begin_attempt() noexcept;
  void end_attempt() noexcept;

  CamAxes desired_;
  CamAxes longest_;
  CamAxes free_{};  // known to be
  CamAxes stands_{};
  std::size_t axis_{0};
  std::array<std::optional<CamAxes>, 3> stuck_{};  // where it was when it could not go on
  // The attempt: along axis_, fewer than `beyond_` cells from free_ on.
  bool is_trying_{false};
  bool has_met_{false};  // what it cannot pass, `beyond_` cells away
  int way_{0};           // -1, +1
  int beyond_{0};
  int cells_{0};              // of the trail that lie on it
  CamAxes touching_{};        // likewise, where it was stuck
  std::vector<int> reaches_;  // of the round's kicks: cells from free_
};

}  // namespace thimble::world::cam
