#pragma once

#include <string_view>

#include "drivers/phantom/phantom_models.hpp"  // generated from phantom_models.toml

namespace thimble::phantom {

// The model of that name, or nullptr. The table lives as long as the program. Any thread.
[[nodiscard]] constexpr const PhantomModel* find_model(std::string_view name) noexcept {
  for (const PhantomModel& model : kPhantomModels) {
    if (model.name == name) return &model;
  }
  return nullptr;
}

}  // namespace thimble::phantom
