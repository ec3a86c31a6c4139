#pragma once

#include <cstdint>

namespace thimble::campaign {

// Chance from a seed: the same on every machine and compiler. Mixer: splitmix64 (Steele, Lea,
// Flood 2014).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) noexcept : state_(seed) {}

  [[nodiscard]] std::uint64_t bits() noexcept {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t x = state_;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }
  // In [low, high).
  [[nodiscard]] double uniform(double low, double high) noexcept {
    constexpr double kTwoTo53 = 9007199254740992.0;
    return low + (high - low) * (static_cast<double>(bits() >> 11U) / kTwoTo53);
  }
  // In [0, n), n > 0.
  [[nodiscard]] std::uint64_t below(std::uint64_t n) noexcept { return bits() % n; }
  [[nodiscard]] bool chance(double probability) noexcept { return uniform(0, 1) < probability; }

 private:
  std::uint64_t state_;
};

// The seed of part `index` of what `seed` began.
[[nodiscard]] inline std::uint64_t derive(std::uint64_t seed, std::uint64_t index) noexcept {
  Dice dice(seed);
  Dice of_part(dice.bits() ^ (index * 0xd1342543de82ef95U));
  return of_part.bits();
}

}  // namespace thimble::campaign
