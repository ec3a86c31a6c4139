#pragma once

#include <cstdint>

#include "drivers/spacemouse/spacemouse_models.hpp"  // generated from spacemouse_models.toml

namespace thimble::spacemouse {

// The puck of these ids, or nullptr. The table lives as long as the program. Any thread.
[[nodiscard]] constexpr const SpaceMouseModel* find_model(std::uint16_t vendor_id,
                                                          std::uint16_t product_id) noexcept {
  for (const SpaceMouseModel& model : kSpaceMouseModels) {
    if (model.vendor_id == vendor_id && model.product_id == product_id) return &model;
  }
  return nullptr;
}

}  // namespace thimble::spacemouse
