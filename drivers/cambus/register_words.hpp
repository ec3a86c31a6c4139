#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/cambus/cambus_registers.hpp"

namespace thimble::cambus {

// Layer n is bit n.
using LayerMask = std::uint16_t;
inline constexpr LayerMask kAllLayers = 0xffff;

// What one register holds in the 16 layers of a module, as the bus carries it: word k has bit k of
// every layer. For registers of a fixed length; the ports carry plain words.
// Thread: one at a time.
class RegisterWords {
 public:
  explicit RegisterWords(Register number);  // all 0

  // Sets a field of `of` in some layers; the value's bits beyond the field are dropped, so that a
  // negative amount is its two's complement.
  RegisterWords& set(const Field& of, std::uint32_t value, LayerMask layers = kAllLayers);
  [[nodiscard]] std::uint32_t get(const Field& of, int layer) const;

  [[nodiscard]] Register number() const { return number_; }
  [[nodiscard]] std::span<const std::uint16_t> words() const { return words_; }
  [[nodiscard]] std::span<std::uint16_t> words() { return words_; }
  bool operator==(const RegisterWords&) const = default;

 private:
  Register number_;
  std::vector<std::uint16_t> words_;
};

// What MIT's software writes where a program says nothing (docs/cambus.md, section 2).
[[nodiscard]] RegisterWords default_words(Register number);

}  // namespace thimble::cambus
