#include "drivers/cambus/register_words.hpp"

#include <array>
#include <cstddef>

#include "hal/base/check.hpp"

namespace thimble::cambus {
namespace {

// Pins of the chips of a module by layer, where they are not 0.
constexpr std::array<std::uint32_t, kLayers> kPinA{2, 1, 16, 24, 3, 5};
constexpr std::array<std::uint32_t, kLayers> kPinB{0, 2, 16, 24, 3, 4, 0, 0, 0, 0, 4};

}  // namespace

RegisterWords::RegisterWords(Register number) : number_(number), words_(facts_of(number).bits, 0) {
  THIMBLE_CHECK(!words_.empty());
}

RegisterWords& RegisterWords::set(const Field& of, std::uint32_t value, LayerMask layers) {
  THIMBLE_CHECK(of.of == number_);
  for (std::size_t bit = 0; bit < of.bits; ++bit) {
    std::uint16_t& word = words_[of.first_bit + bit];
    const bool is_set = ((value >> bit) & 1U) != 0;
    word = static_cast<std::uint16_t>(is_set ? word | layers : word & ~layers);
  }
  return *this;
}

std::uint32_t RegisterWords::get(const Field& of, int layer) const {
  THIMBLE_CHECK(of.of == number_);
  std::uint32_t value = 0;
  for (std::size_t bit = 0; bit < of.bits; ++bit) {
    if (((words_[of.first_bit + bit] >> layer) & 1U) != 0) value |= 1U << bit;
  }
  return value;
}

RegisterWords default_words(Register number) {
  RegisterWords words(number);
  for (const Field& of : facts_of(number).fields) words.set(of, of.initial);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    const auto of_layer = static_cast<LayerMask>(1U << layer);
    if (number == Register::LutPerm) {
      words.set(field::kLutPerm[0], static_cast<std::uint32_t>(layer), of_layer);
    }
    if (number == Register::Multi) {
      words.set(field::kMulti[0], kPinA[layer], of_layer);
      words.set(field::kMulti[1], kPinB[layer], of_layer);
    }
  }
  return words;
}

}  // namespace thimble::cambus
