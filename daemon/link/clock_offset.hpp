#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "daemon/link/link_counters.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// How far two monotonic clocks are apart, and how long each way takes, from exchanges of four
// times (RFC 5905 section 8): sent t1 and received t4 on our clock, received t2 and sent t3 on
// theirs. t2 − t1 is the way there plus the offset, t4 − t3 the way back minus it; the least of
// each over the last kWindow is taken for a datagram that nothing held up, and both ways for
// equally long then:
//
//   offset = (least(t2 − t1) − least(t4 − t3)) / 2      their clock minus ours
//
// Nothing tells unequal ways apart: whatever they are, and with clocks that drift by up to
// kMaxDrift_ratio, the truth is within error() of it.
//
// Thread: one. RT: bounded, allocation-free. Errors: none; an exchange that cannot have been (back
// before it left, or ways of negative length beyond the drift) begins anew: a clock was set, or the
// peer is another one.
class ClockOffset {
 public:
  // Ours: long enough that jitter leaves a gap, short enough that drift stays below 1 ms.
  static constexpr Duration kWindow = std::chrono::seconds(8);
  static constexpr double kMaxDrift_ratio = 100e-6;  // two bad crystals; RFC 5905 has 15 ppm of one

  struct Exchange {
    MonotonicTime sent{};       // t1, ours
    MonotonicTime arrived{};    // t2, theirs
    MonotonicTime answered{};   // t3, theirs
    MonotonicTime came_back{};  // t4, ours
  };

  void note(const Exchange& exchange) noexcept;
  void reset() noexcept { *this = {}; }

  [[nodiscard]] bool is_known() const noexcept { return newest_.has_value(); }
  // All 0 until known.
  [[nodiscard]] Duration offset() const noexcept;
  [[nodiscard]] Duration error() const noexcept;
  [[nodiscard]] ClockStatus status() const noexcept;
  // Of the newest exchanges, smoothed as a round trip is (RFC 6298, 1/8).
  [[nodiscard]] Duration way_there() const noexcept;
  [[nodiscard]] Duration way_back() const noexcept;

 private:
  static constexpr std::size_t kSlots = 16;
  static constexpr Duration kSlot = kWindow / kSlots;
  struct Least {
    Duration there{Duration::max()};
    Duration back{Duration::max()};
    std::int64_t number{-1};  // of the slot's time; -1: empty
  };

  [[nodiscard]] Least least() const noexcept;

  std::array<Least, kSlots> slots_{};
  std::optional<std::int64_t> newest_;  // number of the newest slot
  Duration there_{};                    // smoothed t2 - t1
  Duration back_{};                     // smoothed t4 - t3
};

}  // namespace thimble::link
