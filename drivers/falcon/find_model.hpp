#pragma once

#include <string_view>

#include "drivers/falcon/falcon_models.hpp"  // generated from falcon_models.toml

namespace thimble::falcon {

// The model of that name, or nullptr. The table lives as long as the program. Any thread.
[[nodiscard]] constexpr const FalconModel* find_model(std::string_view name) noexcept {
  for (const FalconModel& model : kFalconModels) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

}  // namespace thimble::falcon
