#pragma once

#include <compare>
#include <cstdint>

namespace thimble {

// Raw hardware numbers. Integers of different meaning do not mix, and none converts to SI
// but in a codec or a kinematics file.
struct EncoderCounts {
  std::int32_t value{};
  auto operator<=>(const EncoderCounts&) const = default;
  friend constexpr EncoderCounts operator+(EncoderCounts a, EncoderCounts b) noexcept {
    return {a.value + b.value};
  }
  friend constexpr EncoderCounts operator-(EncoderCounts a, EncoderCounts b) noexcept {
    return {a.value - b.value};
  }
};

struct DacCounts {
  std::int32_t value{};
  auto operator<=>(const DacCounts&) const = default;
};

// SI scalars that must not be confused with each other; operators are in geometry.hpp.
struct Stiffness {
  double newton_per_m{};
  auto operator<=>(const Stiffness&) const = default;
};

struct Damping {
  double newton_s_per_m{};
  auto operator<=>(const Damping&) const = default;
};

}  // namespace thimble
