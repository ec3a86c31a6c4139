#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/cambus/cambus_registers.hpp"

namespace thimble::sim::cam {

// The registers of the 16 chips of a module: plane k of a register has bit k of each layer.
class CamRegisters {
 public:
  [[nodiscard]] std::uint32_t get(const cambus::Field& of, std::size_t layer) const noexcept {
    std::uint32_t value = 0;
    for (std::size_t bit = 0; bit < of.bits; ++bit) {
      const std::uint32_t plane = planes(of.of)[of.first_bit + bit];
      value |= ((plane >> layer) & 1U) << bit;
    }
    return value;
  }
  // Of all layers at once, quickly where they say the same.
  using ByLayer = std::array<std::uint32_t, cambus::kLayers>;
  [[nodiscard]] ByLayer by_layer(const cambus::Field& of) const noexcept {
    ByLayer values{};
    std::uint32_t common = 0;
    for (std::size_t bit = 0; bit < of.bits; ++bit) {
      const std::uint32_t plane = planes(of.of)[of.first_bit + bit];
      if (plane == 0xffff) common |= 1U << bit;
      if (plane == 0 || plane == 0xffff) continue;
      for (std::size_t layer = 0; layer < values.size(); ++layer) {
        values[layer] |= (plane >> layer & 1U) << bit;
      }
    }
    for (std::uint32_t& value : values) value |= common;
    return values;
  }
  void set(const cambus::Field& of, std::size_t layer, std::uint32_t value) noexcept {
    for (std::size_t bit = 0; bit < of.bits; ++bit) {
      std::uint16_t& plane = planes(of.of)[of.first_bit + bit];
      const std::uint32_t cleared = plane & ~(1U << layer);
      plane = static_cast<std::uint16_t>(cleared | ((value >> bit) & 1U) << layer);
    }
  }

  // In all layers, modulo 2^bits: a carry for each of them from bit to bit.
  void add(const cambus::Field& of, std::uint32_t amount) noexcept {
    std::uint32_t carry = 0;
    for (std::size_t bit = 0; bit < of.bits; ++bit) {
      std::uint16_t& plane = planes(of.of)[of.first_bit + bit];
      const std::uint32_t more = (amount >> bit & 1U) != 0 ? 0xffffU : 0U;
      const std::uint32_t sum = plane ^ more ^ carry;
      carry = (plane & more) | (carry & (plane ^ more));
      plane = static_cast<std::uint16_t>(sum);
    }
  }

  using Planes = std::array<std::uint16_t, cambus::kMaxRegisterBits>;
  [[nodiscard]] Planes& planes(cambus::Register number) noexcept {
    return all_[static_cast<std::size_t>(number)];
  }
  [[nodiscard]] const Planes& planes(cambus::Register number) const noexcept {
    return all_[static_cast<std::size_t>(number)];
  }

 private:
  std::array<Planes, cambus::kRegisterCount> all_{};
};

}  // namespace thimble::sim::cam
