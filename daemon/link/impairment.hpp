#pragma once

#include <cstdint>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace thimble::link {

// What a link is made to suffer, so that a network can be had on one table (thesis 4.1).
// It is added to what the carriage does by itself.
//
// Delay and jitter are of the ROUND TRIP, as in the thesis's table 4.1: delay_s = 0.1 makes
// every round trip 100 ms longer. Half is applied in each direction, so that hand and world
// are as far apart as over a real network (teleop.md: D = 2T). Loss, duplication and
// reordering are probabilities of one message in one direction, as network tools count them:
// of the round trips, (1 - loss)^2 survive. docs/decisions/0060.
struct ImpairmentSettings {
  double delay_s{0};    // 0 … kMaxDelay_s
  double jitter_s{0};   // the delay is uniform in delay ± jitter, never below 0; keeps the order
  double loss{0};       // 0 … 1
  double duplicate{0};  // 0 … 1; the copy follows at once
  double reorder{0};    // 0 … 1; the message is held back kReorderHold so that others overtake
  std::uint64_t seed{1};

  static constexpr double kMaxDelay_s = 2.0;  // twice what thesis 4.1 calls conceivable
  static constexpr Duration kReorderHold = std::chrono::milliseconds(5);

  bool operator==(const ImpairmentSettings&) const = default;
  [[nodiscard]] bool is_active() const noexcept {
    return delay_s > 0 || jitter_s > 0 || loss > 0 || duplicate > 0 || reorder > 0;
  }
};

// Errors: InvalidArgument naming the key and its range.
[[nodiscard]] Result<void> validate(const ImpairmentSettings& settings);

// What has been done to the messages of one direction.
struct ImpairmentCounters {
  std::uint64_t lost{0};
  std::uint64_t duplicated{0};
  std::uint64_t reordered{0};
  std::uint64_t overflowed{0};  // the queue was full: the newest is refused
};

// The fate of one message, drawn from a seeded sequence: the same seed gives the same fates
// on every machine and compiler. Every message takes the same number of draws, so changing
// one probability does not change the fates along the others.
//
// Thread: one. RT: draw() allocates nothing. Errors: none; settings must be valid.
class ImpairmentDice {
 public:
  struct Fate {
    Duration delay{};
    bool is_lost{false};
    bool is_duplicated{false};
    bool is_held_back{false};
  };

  // `direction` separates the two sequences of one link.
  ImpairmentDice(const ImpairmentSettings& settings, std::uint64_t direction) noexcept;
  [[nodiscard]] Fate draw() noexcept;

 private:
  [[nodiscard]] double uniform() noexcept;  // [0, 1)

  ImpairmentSettings settings_;
  std::uint64_t state_;
};

}  // namespace thimble::link
