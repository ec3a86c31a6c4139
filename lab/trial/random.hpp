#pragma once

#include <cstdint>

namespace thimble::lab {

// A seeded sequence that is the same on every machine and compiler, which the distributions of the
// standard library are not. SOURCE: Steele, Lea and Flood, "Fast splittable pseudorandom number
// generators" (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}

  std::uint64_t next() noexcept {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }
  // [low, high)
  double uniform(double low, double high) noexcept {
    return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }

 private:
  std::uint64_t state_;
};

}  // namespace thimble::lab
