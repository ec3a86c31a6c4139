#pragma once

#include <cstddef>
#include <cstdint>

namespace thimble::world {

// What the hand that is in a world may ask of it, beside what its buttons say. Thread: any.
enum class HandAction : std::uint8_t {
  ToggleFree,  // free motion, through everything: on, or off again
  Reset,       // all as it was at first
};
inline constexpr std::size_t kHandActions = 2;

}  // namespace thimble::world
