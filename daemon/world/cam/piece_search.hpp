#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/device/cam_board.hpp"

namespace thimble::world::cam {

enum class SearchKind : std::uint8_t {
  OneCell,  // thesis 4.2.1: a cell an attempt
  Leap,     // thesis 4.2.2: four cells where there are four to go, else by halves; what is thinner
            // than four cells may be leapt over
  Sweep,  // by the shape's trail (piece_sweep.hpp): twice as far with each scan, nothing leapt over
  BoundedSweep,  // the same in scans of what lies around the shape and its way (decision 0411)
};

// OneCell and Leap: how far a shape gets towards where it should go: along x as far as it can, then
// y, then z, and again while that helps (appendix C). Gives one shift after the other and is told
// whether the shape overlaps then. Pure. Thread: one at a time. Errors: none; take() without a
// shift that is looked at is a mistake of the caller.
class PieceSearch {
 public:
  struct Shift {
    CamAxes cells{};
    bool is_looked_at{false};  // else it goes back to where it is known not to overlap
    bool operator==(const Shift&) const = default;
  };

  PieceSearch(SearchKind kind, const CamAxes& desired) noexcept
      : leap_(kind == SearchKind::Leap ? 4 : 1), desired_(desired) {}

  // Nothing: it is over.
  [[nodiscard]] std::optional<Shift> next() noexcept;
  // `overlapping`: how many cells of the shape lie on pieces there.
  void take(int overlapping) noexcept;
  // How far it has got without overlap; nowhere else when it is over.
  [[nodiscard]] const CamAxes& actual() const noexcept { return actual_; }
  // When it is over: along each axis that it has not come to the end of, how many cells would
  // overlap one cell further; else 0.
  [[nodiscard]] CamAxes touching() const noexcept;

 private:
  // The next attempt, if there is one. False: it is over.
  [[nodiscard]] bool begin_attempt() noexcept;
  [[nodiscard]] Shift shift_to(int distance, bool is_looked_at) noexcept;
  void end_attempt() noexcept;

  int leap_;
  CamAxes desired_;
  CamAxes actual_{};
  std::size_t axis_{0};
  std::array<std::optional<CamAxes>, 3> stuck_{};  // where it was when it could not go on
  // The attempt: cells from actual_ on along axis_.
  bool is_trying_{false};
  int way_{0};          // -1, +1
  int at_{0};           // where the shape is
  int free_{0};         // known not to overlap
  int blocked_{0};      // known to, or beyond what is tried
  int overlapping_{0};  // where it is known to
  CamAxes touching_{};  // likewise, where it was stuck
};

}  // namespace thimble::world::cam
