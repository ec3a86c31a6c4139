#pragma once

#include <cstdint>
#include <string_view>

namespace thimble::spacemouse {

// One kind of puck: a row of spacemouse_models.toml. Lives as long as the program.
struct SpaceMouseModel {
  std::string_view name;
  std::string_view description;
  std::uint16_t vendor_id{};
  std::uint16_t product_id{};
  double full_deflection_counts{};  // what an axis says at its stop
};

}  // namespace thimble::spacemouse
