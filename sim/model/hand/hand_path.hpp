#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/base/time.hpp"
#include "hal/rt/annotations.hpp"
#include "sim/model/hand/hand_settings.hpp"
#include "sim/model/hand/stroke.hpp"

namespace thimble::sim {

// Where the person wants the finger: a motion as a function of time, from the origin at rest,
// without end. Velocity is continuous. Base frame.
//
// Thread: one. RT: advance(): no allocation, bounded. Errors: none for checked settings.
class HandPath {
 public:
  explicit HandPath(const HandSettings& settings) noexcept;
  THIMBLE_RT PathPoint advance(Duration dt) noexcept;

 private:
  static constexpr std::size_t kTargets = 14;  // 6 faces, 8 corners
  static constexpr std::size_t kSines = 4;     // 1 of the drift, 3 of the tremor
  struct Sine {
    double amplitude_m{}, rad_per_s{}, phase_rad{};
  };

  [[nodiscard]] PathPoint strokes() noexcept;
  [[nodiscard]] PathPoint circle() const noexcept;
  [[nodiscard]] PathPoint tremor() const noexcept;
  void next_stroke() noexcept;
  [[nodiscard]] Position3 next_target() noexcept;
  [[nodiscard]] Position3 explore_target(std::size_t index) noexcept;
  void shuffle() noexcept;
  [[nodiscard]] double random(double low, double high) noexcept;

  HandSettings settings_;
  std::uint64_t random_state_;
  Duration elapsed_{};         // since the start
  Duration stroke_elapsed_{};  // since the stroke's start
  Stroke stroke_{};
  double pause_s_{0};  // after the stroke
  std::size_t stroke_number_{0};
  std::array<std::size_t, kTargets> order_{};
  std::array<std::array<Sine, kSines>, 3> sines_{};  // by axis
};

}  // namespace thimble::sim
