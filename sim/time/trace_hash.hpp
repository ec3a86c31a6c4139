#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "hal/rt/annotations.hpp"

namespace thimble::sim {

// A fingerprint of everything that happened in a run, in order: the same seed must give the
// same value. FNV-1a, 64 bit (Fowler, Noll, Vo; constants as in RFC 9923). It protects
// against change by accident, not by intent.
//
// Thread: any one. RT: all THIMBLE_RT.
class TraceHash {
 public:
  THIMBLE_RT constexpr void add(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes) add_byte(byte);
  }
  // Little endian on every machine. Doubles by their bits: 0.0 and -0.0 differ.
  THIMBLE_RT constexpr void add(std::integral auto value) noexcept {
    auto rest = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(value); ++i) {
      add_byte(static_cast<std::uint8_t>(rest & 0xffU));
      rest >>= 8U;
    }
  }
  THIMBLE_RT constexpr void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }

 private:
  constexpr void add_byte(std::uint8_t byte) noexcept { hash_ = (hash_ ^ byte) * kPrime; }

  static constexpr std::uint64_t kOffsetBasis = 0xcbf29ce484222325U;
  static constexpr std::uint64_t kPrime = 0x100000001b3U;
  std::uint64_t hash_{kOffsetBasis};
};

}  // namespace thimble::sim
